// SPDX-License-Identifier: GPL-3.0-or-later
// A drawing for who has none at hand: a key tag of 60 by 25 mm, cut with its hole, a star marked on it.

export const sampleName = 'key tag.svg';

const star = Array.from({ length: 10 }, (_, i) => {
  const [angle, radius] = [(Math.PI * i) / 5, i % 2 === 0 ? 7 : 3];
  return `${(38 + radius * Math.sin(angle)).toFixed(2)} ${(12.5 - radius * Math.cos(angle)).toFixed(2)}`;
}).join('L');

const drawing = `<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="25mm" viewBox="0 0 60 25">
  <g id="cut" fill="none" stroke="#f00"><rect x="0.5" y="0.5" width="59" height="24" rx="6"/><circle cx="9" cy="12.5" r="3"/></g>
  <g id="mark" fill="none" stroke="#00f"><path d="M${star}Z"/></g>
</svg>
`;

export const sampleDrawing = (): Uint8Array<ArrayBuffer> => new TextEncoder().encode(drawing);
