// SPDX-License-Identifier: GPL-3.0-or-later
// In the order of the list that a person chooses from.
import type { Tutorial } from '../tutorial';
import { evidence } from './evidence';
import { laser } from './laser';
import { relief } from './relief';
import { shell } from './shell';
import { zippable } from './zippable';

export const tutorials: readonly Tutorial[] = [relief, shell, zippable, evidence, laser];
