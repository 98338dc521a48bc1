// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How alike two surfaces look from the viewpoint: the structural similarity of their pictures under many lights, and
// the edges that only the second picture has.
#include <span>

#include "relief/seen/normal_picture.h"

namespace formwright {

/// `count` unit vectors (right, up, towards the viewer), spread evenly over the half sphere on the viewer's side: a
/// Fibonacci lattice (Gonzalez 2010).
std::vector<Vec3> light_directions(int count);

inline constexpr int usual_light_count = 32;

/// Mean structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004, eq. 13) over lights and over the pixels that both
/// pictures cover: 1 for equal pictures. Matte surfaces under one directional light, eq. (3.1) without ambient light,
/// brightness max(0, l . n) from 0 to 1. Gaussian window of 1.5 pixels, 11 x 11, constants 0.01^2 and 0.03^2; pixels
/// that are not covered by both have no weight in it. 1 where no pixel is covered by both.
/// Both pictures are on one grid. Throws Error: cancelled.
double picture_similarity(const NormalPicture& model, const NormalPicture& relief, std::span<const Vec3> lights,
                          Context& context);

/// The same of two pictures of brightness, 0 to 1, rows * columns, over the pixels of `mask`: for light that casts
/// shadows.
double brightness_similarity(int columns, int rows, const std::vector<float>& model, const std::vector<float>& relief,
                             const std::vector<char>& mask, Context& context);

/// Share of the covered pixels, in percent, that lie on a false edge: the relief's normals turn there as at a crease of
/// 30 degrees or more, while the model's nowhere within 6 pixels turn as at a crease of 15. Normals are smoothed by a
/// Gaussian of 3 pixels before they are differentiated, as in Canny 1986, who also has the two thresholds; over all
/// directions of light the mean square of the brightness' gradient is a third of that of the normals.
/// Throws Error: cancelled.
double false_edges_percent(const NormalPicture& model, const NormalPicture& relief, Context& context);

}  // namespace formwright
