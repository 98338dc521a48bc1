// SPDX-License-Identifier: GPL-3.0-or-later
export const gap: string;
export function stringsIn(path: string, source: string): string[];
export function pageSources(): { path: string; source: string }[];
export function pageStrings(): string[];
export function catalogStrings(): string[];
export function causeStrings(): string[];
export function draw(strings: readonly string[], count: number, seed: number): string[];
