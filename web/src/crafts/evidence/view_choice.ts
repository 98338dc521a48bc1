// SPDX-License-Identifier: GPL-3.0-or-later
// Which pictures of an object the room shows; the choice outlives a visit to another room.
import { signal } from '@preact/signals';

type View = 'plane' | 'object' | 'print';
export const view = signal<View>('plane');
