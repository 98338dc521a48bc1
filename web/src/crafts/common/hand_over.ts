// SPDX-License-Identifier: GPL-3.0-or-later
// Rooms do not know each other; what one makes for a machine goes through here. The app says where to.
import { signal } from '@preact/signals';

export type HandOver = (file_name: string, drawing: Uint8Array<ArrayBuffer>) => Promise<void>;

/** Null while there is nowhere to send to. */
export const sendToMachine = signal<HandOver | null>(null);
