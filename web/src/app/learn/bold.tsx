// SPDX-License-Identifier: GPL-3.0-or-later

/** Text whose **words** between stars are bold. */
export function Bold({ text }: { text: string }) {
  return <>{text.split('**').map((piece, i) => (i % 2 === 1 ? <strong key={i}>{piece}</strong> : piece))}</>;
}
