// SPDX-License-Identifier: GPL-3.0-or-later

/** A phone: the inspector is a sheet, the rail a bar. */
export const narrow = () => window.innerWidth <= 720;
