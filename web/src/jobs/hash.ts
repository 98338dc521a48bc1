// SPDX-License-Identifier: GPL-3.0-or-later

/** SHA-256 as 64 lower-case hex digits: the name of a blob everywhere. */
export async function sha256Hex(bytes: Uint8Array<ArrayBuffer>): Promise<string> {
  const digest = new Uint8Array(await crypto.subtle.digest('SHA-256', bytes));
  return Array.from(digest, (byte) => byte.toString(16).padStart(2, '0')).join('');
}
