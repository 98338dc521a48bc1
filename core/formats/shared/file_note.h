// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Words in a file that change nothing of what it shows or makes.
#include <string_view>

#include "base/bytes.h"

namespace formwright {

/// Has the format a place for a note?
bool takes_note(std::string_view media_type);

/// Puts a note into a file of this program: a comment of PLY, OBJ and zip archives (3MF is one), `metadata` of SVG, a
/// tEXt chunk of PNG, `extras` of GLB, the subject of a PDF; the words alone in a comment of DXF and, where they fit
/// into the 80 bytes before the triangles, in a binary STL. Other formats, and files that are not as this program
/// writes them, stay as they are.
/// @param media_type  of the file, such as "image/png"
/// @param json        an object in one line of ASCII, of at most 65,535 characters
/// @param words       the same for where there is little room
void add_note(Bytes& file, std::string_view media_type, std::string_view json, std::string_view words);

}  // namespace formwright
