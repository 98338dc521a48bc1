// SPDX-License-Identifier: GPL-3.0-or-later

/** "12.5" and "12,5"; null for anything else. */
export function lengthIn(text: string): number | null {
  const plain = text.trim().replace(',', '.').replace('\u2212', '-');
  if (!/^[+-]?(\d+\.?\d*|\.\d+)$/.test(plain)) return null;
  return Number(plain);
}
