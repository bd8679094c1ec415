#pragma once
/// \file
/// The rigid bed of reproduce/rigid_bed.hpp, made available in the namespace of the tests.

#include "reproduce/rigid_bed.hpp"

namespace twincell::test {

using reproduce::film_rigid_bed;
using reproduce::rigid_bed;
using reproduce::rigid_bed_height;
using reproduce::rigid_bed_info;
using reproduce::RigidBed;

}  // namespace twincell::test
