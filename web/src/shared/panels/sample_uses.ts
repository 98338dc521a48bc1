// SPDX-License-Identifier: GPL-3.0-or-later
import type { Sample } from '../../jobs/contract';

/** Limbs and rounded bodies that one ribbon covers well, easy ones first. */
export const zippableSamples: readonly string[] = ['star', 'heart', 't_shape', 'octopus', 'cat', 'torus'];

/** "Relief, coloured shell, zippable": what a sample is good for. */
export const usesOf = ({ name, has_texture }: Sample): string =>
  [
    'Relief',
    has_texture ? 'coloured shell' : 'shell',
    ...(zippableSamples.includes(name) ? ['zippable'] : []),
  ].join(', ');
