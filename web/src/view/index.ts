// SPDX-License-Identifier: GPL-3.0-or-later
export type * from './api';
export { legendFor, sampleStops, stopsOf, tickStep } from './colour_map';
export { LightBall } from './light_ball';
export { prepareShading, turnedShading } from './shading';
export { SideInset } from './side_inset';
export { renderThumbnail } from './thumbnail';
export { Viewport } from './viewport';
