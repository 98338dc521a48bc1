// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures on the start screen; `draw_pictures` makes them, loaded only when they are wanted.
import { signal } from '@preact/signals';

/** Object URLs by name: a sample's, or "craft:relief". */
export const pictures = signal<Readonly<Record<string, string>>>({});
