// SPDX-License-Identifier: GPL-3.0-or-later
export * from './button';
export * from './dialog';
export * from './icon';
export * from './job_strip';
export * from './menu';
export * from './note';
export * from './numbers';
export * from './parameter';
export * from './segmented';
export * from './sheet';
export * from './switch';
export * from './tip';
export * from './toast';
