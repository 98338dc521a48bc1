// SPDX-License-Identifier: GPL-3.0-or-later
export type * from './api';
export { legendFor, sampleStops, stopsOf, tickStep } from './mesh/colour_map';
export { prepareFlatSides } from './mesh/flat_sides';
export { LightBall } from './overlay/light_ball';
export { prepareShading, turnedShading } from './mesh/shading';
export { SideInset } from './overlay/side_inset';
export { renderThumbnail } from './render/thumbnail';
export { Viewport } from './viewport';
