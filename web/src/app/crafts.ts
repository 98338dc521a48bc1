// SPDX-License-Identifier: GPL-3.0-or-later
// The places of the rail, in order, and what is said about them.
import type { IconName } from '../ui';
import type { Place } from './route';

export interface Craft {
  readonly place: Place;
  readonly title: string;
  readonly icon: IconName;
  readonly pitch: string;
  readonly makes: string;
  /** Stands apart in the rail. */
  readonly apart?: boolean;
}

export const crafts: readonly Craft[] = [
  {
    place: 'relief',
    title: 'Relief',
    icon: 'relief',
    pitch: 'A model pressed into a few millimetres that still looks deep.',
    makes: 'Carve, print, cast',
  },
  {
    place: 'thermoform',
    title: 'Thermoform',
    icon: 'thermoform',
    pitch: 'A plastic shell, formed over the model, with a print that fits it.',
    makes: 'Vacuum former, printer',
  },
  {
    place: 'zippable',
    title: 'Zippable',
    icon: 'zippable',
    pitch: 'A flat ribbon that zips up into the shape.',
    makes: 'Laser cutter, sewing',
  },
  {
    place: 'evidence',
    title: 'Evidence',
    icon: 'evidence',
    pitch: 'Find out why a formed part came out wrong.',
    makes: 'Scan, photo, calliper',
    apart: true,
  },
  {
    place: 'machines',
    title: 'Machines',
    icon: 'machines',
    pitch: 'Send a job to the cutter, printer or mill, and stop it at once.',
    makes: 'Laser, printer, mill',
  },
];
