#pragma once

#include <string>

#include "mesh/box_tree.h"

namespace argil::run {

/// A line for the user: what it is about, and what is so.
void say(const std::string& subject, const std::string& text);

/// Of a box, from corner to corner [m].
double size_of(const mesh::Box& box);

/// Of the vertices that the body has, in the file's unit: a surface's may hold others. Throws InputError.
mesh::Box read_box(const std::string& file);

/// Why a surface is not closed, in words; empty where it is, and of tetrahedra.
std::string find_hole(const std::string& file);

/// Metres per unit of the mesh: `given` as m, cm, mm, um or a number; or, where it is empty, by the size of
/// the box, which is said where it speaks for another unit than metres. Throws InputError.
double choose_scale(const std::string& file, const std::string& given, const mesh::Box& box);

}  // namespace argil::run
