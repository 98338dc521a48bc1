// SPDX-License-Identifier: GPL-3.0-or-later

const colours = 'abcdefgh';
/** The style sheet's name of the colour of one thing among several, from 0. From the ninth on colours come again: numbers distinguish them. */
export const colourToken = (index: number): string => `--seg-${colours[index % colours.length] ?? 'a'}`;
