// SPDX-License-Identifier: GPL-3.0-or-later
// What the C++ side is built from beside our own code; a test compares it with the includes.

export interface SolverPart {
  readonly name: string;
  readonly licence: string;
  readonly use: string;
  /** The first word of its includes. */
  readonly include: string;
}

/** Built into the solver rather than the page; the full texts come with the source. */
export const solverParts: readonly SolverPart[] = [
  { name: 'Eigen', licence: 'MPL-2.0', use: 'linear algebra', include: 'Eigen' },
  { name: 'Boost', licence: 'BSL-1.0', use: 'server of the worker program', include: 'boost' },
  { name: 'CGAL', licence: 'GPL-3.0-or-later and LGPL-3.0-or-later', use: 'exact booleans', include: 'CGAL' },
  { name: 'nlohmann/json', licence: 'MIT', use: 'messages', include: 'nlohmann' },
  { name: 'fast_float', licence: 'MIT or Apache-2.0', use: 'numbers in files', include: 'fast_float' },
  { name: 'libpng', licence: 'libpng-2.0', use: 'pictures', include: 'png' },
  { name: 'libharu', licence: 'Zlib', use: 'pages to print', include: 'hpdf' },
  { name: 'stb_image', licence: 'MIT or public domain', use: 'JPEG pictures', include: 'stb_image' },
  { name: 'OpenCV', licence: 'Apache-2.0', use: 'smaller and blurred pictures of scans', include: 'opencv2' },
  { name: 'Expat', licence: 'MIT', use: '3MF', include: 'expat' },
  { name: 'pugixml', licence: 'MIT', use: 'drawings', include: 'pugixml' },
  { name: 'SVG++', licence: 'BSL-1.0', use: 'drawings', include: 'svgpp' },
  { name: 'Clipper', licence: 'BSL-1.0', use: 'kerf', include: 'polyclipping' },
  { name: 'CUPS', licence: 'Apache-2.0', use: 'printers, in the worker program', include: 'cups' },
  { name: 'QPDF', licence: 'Apache-2.0', use: 'pages to print, in the worker program', include: 'qpdf' },
  { name: 'curl', licence: 'curl', use: 'uploads, in the worker program', include: 'curl' },
  { name: 'CLI11', licence: 'BSD-3-Clause', use: 'the command line', include: 'CLI' },
  { name: 'Embree', licence: 'Apache-2.0', use: 'rays, in the worker program', include: 'embree3' },
  { name: 'oneTBB', licence: 'Apache-2.0', use: 'threads of Embree, in the worker program', include: 'tbb' },
  { name: 'zlib', licence: 'Zlib', use: 'compressed files', include: 'zlib' },
];
