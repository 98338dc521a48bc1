// SPDX-License-Identifier: GPL-3.0-or-later
export type * from './api';
export { formatValue, legendFor, sampleStops, statisticsOf, stopsOf, tickStep } from './colour_map';
export { formatLength } from './dimensions';
export { DEFAULT_LIGHT, spokenLight } from './light';
export { LightBall } from './light_ball';
export { cutOutline, outlineMeasures } from './section';
export { prepareShading, turnedShading } from './shading';
export { SideInset } from './side_inset';
export { renderThumbnail } from './thumbnail';
export { Viewport } from './viewport';
