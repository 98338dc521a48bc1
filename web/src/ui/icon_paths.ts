// SPDX-License-Identifier: GPL-3.0-or-later
// Icons on a 24 px grid with a 1.5 px line, as SVG markup. Static text of ours: safe to insert as is.

export const iconPaths = {
  relief:
    '<rect x="3" y="4" width="18" height="16" rx="2.5"/><path d="M6.5 16c.4-5 2.5-8 5.5-8s5.1 3 5.5 8z"/>',
  thermoform:
    '<path d="M2.5 9h3.5c2 0 2.5 7.5 6 7.5s4-7.5 6-7.5h3.5" transform="matrix(1 0 0 -1 0 24)"/><path d="M8 19.5a4.3 4.3 0 0 1 8 0"/><path d="M2.5 21h19"/>',
  zippable:
    '<path d="M12 12.5a2 2 0 0 1 4 0 4 4 0 0 1-8 0 6 6 0 0 1 12 0 8 8 0 0 1-16 0"/><path d="M4 12.5c0-3.7 1.5-6.5 4-8.5"/>',
  evidence:
    '<path d="M3.5 3.5v17h17"/><path d="M6.5 15.5c3-8 5-8 7-4.5s4 3 6.5-3"/><path d="M9 6.5v-2M9 14.5v-2M14 16.5v-2M18.5 17.5v-2" />',
  machines:
    '<path d="M4.5 20.5V5h15v15.5M2.5 20.5h19M4.5 8.5H9.5M14.5 8.5h5"/><rect x="9.5" y="6.5" width="5" height="5" rx="1"/><path d="M12 11.5v5"/>',
  undo: '<path d="M8 4L4 8l4 4"/><path d="M4 8h10a5.5 5.5 0 0 1 0 11h-3"/>',
  redo: '<path d="M16 4l4 4-4 4"/><path d="M20 8H10a5.5 5.5 0 0 0 0 11h3"/>',
  sun: '<circle cx="12" cy="12" r="4"/><path d="M12 2.5v2M12 19.5v2M2.5 12h2M19.5 12h2M5.3 5.300l1.4 1.400M17.3 17.300l1.4 1.400M18.7 5.300l-1.4 1.400M6.7 17.300l-1.4 1.4"/>',
  help: '<circle cx="12" cy="12" r="9"/><path d="M9.5 9.5a2.5 2.5 0 1 1 3.6 2.200c-.8.4-1.1.9-1.1 1.8"/><path d="M12 16.800v.1"/>',
  chevronDown: '<path d="M7 10l5 5 5-5"/>',
  chevronRight: '<path d="M9 6l6 6-6 6"/>',
  more: '<path d="M5 12h.01M12 12h.01M19 12h.01" stroke-width="2.5"/>',
  check: '<path d="M5 12.5l4.5 4.5L19 7.5" stroke-width="2"/>',
  clock: '<circle cx="12" cy="12" r="8.5"/><path d="M12 7.5V12l3 2"/>',
  warn: '<path d="M12 4L2.8 20h18.400z"/><path d="M12 10v4.5M12 17.200v.1"/>',
  close: '<path d="M6 6l12 12M18 6L6 18"/>',
  chevronLeft: '<path d="M15 6l-6 6 6 6"/>',
  minus: '<path d="M5 12h14"/>',
  plus: '<path d="M12 5v14M5 12h14"/>',
  eye: '<path d="M2.5 12S6 5.5 12 5.5 21.5 12 21.5 12 18 18.5 12 18.5 2.5 12 2.5 12z"/><circle cx="12" cy="12" r="3"/>',
  lock: '<rect x="5" y="11" width="14" height="9.5" rx="2"/><path d="M8 11V8a4 4 0 0 1 8 0v3"/>',
  flat: '<path d="M3 16h18v3H3z"/>',
  upload: '<path d="M12 15V4M7.5 8.5L12 4l4.5 4.5"/><path d="M4 15v4.5h16V15"/>',
  download: '<path d="M12 4v11M7.5 10.5L12 15l4.5-4.5"/><path d="M4 16v3.5h16V16"/>',
  play: '<path d="M7 4.5v15l12-7.5z"/>',
  pause: '<path d="M8 5v14M16 5v14" stroke-width="2.5"/>',
  stop: '<rect x="6" y="6" width="12" height="12" rx="1.5"/>',
  frame: '<path d="M4 8V4h4M16 4h4v4M20 16v4h-4M8 20H4v-4"/>',
  home: '<path d="M4 11l8-7 8 7"/><path d="M6.5 9.5V20h11V9.5"/>',
  loop: '<ellipse cx="12" cy="12" rx="4" ry="8.5"/><path d="M2.5 12H8M16 12h5.5"/>',
  scissors:
    '<circle cx="6.5" cy="17.5" r="2.5"/><circle cx="6.5" cy="6.5" r="2.5"/><path d="M8.6 8L20 16.5M8.6 16L20 7.5"/>',
  print: '<path d="M7 9V4h10v5M7 17H4v-6.5h16V17h-3"/><path d="M7 14h10v6.5H7z"/>',
  move: '<path d="M12 3v18M3 12h18M9.5 5.500L12 3l2.500 2.500M9.500 18.500L12 21l2.500-2.500M5.500 9.500L3 12l2.500 2.500M18.500 9.500L21 12l-2.500 2.500"/>',
  turn: '<path d="M17 8.500c2.700.8 4.500 2.100 4.500 3.500 0 2.500-4.300 4.500-9.500 4.500S2.500 14.500 2.500 12s4.300-4.500 9.500-4.500"/><path d="M9.500 4.500l3 3-3 3"/>',
  tiltSideways:
    '<path d="M5 19A10.500 10.500 0 0 1 18.500 8.500"/><path d="M15 5l3.800 3.400-3 4"/><path d="M3 20.500h18"/>',
  tiltForwards:
    '<path d="M12 3.500v13M8.500 7L12 3.500 15.500 7M8.500 13l3.500 3.500 3.500-3.500"/><path d="M3 20.500h18"/>',
  swap: '<path d="M9 7l-5 5 5 5M15 7l5 5-5 5"/>',
  file: '<path d="M6 3h8l4 4v14H6z"/><path d="M14 3v4h4"/>',
  arrow: '<path d="M5 12h14M13 6l6 6-6 6"/>',
  moon: '<path d="M19.5 14.5A8 8 0 0 1 9.5 4.5a8 8 0 1 0 10 10z"/>',
  trash: '<path d="M5 7h14M10 7V4.5h4V7M7 7l1 13h8l1-13"/>',
  pencil: '<path d="M5 19l1-4L16.5 4.5l3 3L9 18z"/>',
  search: '<circle cx="10.5" cy="10.5" r="6"/><path d="M15 15l5 5"/>',
  link: '<path d="M10 14a4.500 4.500 0 0 0 6.400 0l3-3A4.500 4.500 0 0 0 13 4.600l-1.500 1.500"/><path d="M14 10a4.500 4.500 0 0 0-6.400 0l-3 3A4.500 4.500 0 0 0 11 19.400l1.500-1.500"/>',
  copy: '<rect x="8" y="8" width="12" height="12" rx="2"/><path d="M16 8V4H4v12h4"/>',
} as const;

export type IconName = keyof typeof iconPaths;
