#pragma once
/// \file
/// The scene as data: what is in the cell, read from TOML and checked. Every key: docs/scene.md.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/trajectory/config.hpp"
#include "analysis/trajectory/drive.hpp"
#include "analysis/trajectory/units.hpp"

namespace twincell::sim {

/// Contact parameters of one kind (bead-bead or bead-wall), reduced units.
struct ContactSpec {
  double k_n = 1e6;                   ///< m g/sigma
  std::optional<double> gamma_n;      ///< 1/t0; one of gamma_n, c_n, restitution
  std::optional<double> c_n;          ///< m/t0
  std::optional<double> restitution;  ///< e_n in (0, 1]
  bool tension = true;                ///< false: F_n clipped at 0
  enum class Tangential { none, dashpot, spring } tangential = Tangential::spring;
  double k_t = 1e4;
  std::optional<double> gamma_t;  ///< 1/t0; one of gamma_t, c_t, c_t_over_c_n
  std::optional<double> c_t;
  std::optional<double> c_t_over_c_n;
  double mu = 0.6;
  bool slip_rescales = true;  ///< false: the limit acts on the spring alone
};

enum class StartKind { crystal_a, crystal_b, random, trajectory };

struct Scene {
  std::string file;      ///< for messages
  std::string resolved;  ///< TOML with preset and overrides, for provenance

  double width = 20;             ///< sigma
  std::optional<double> height;  ///< sigma; absent: high enough never to be reached
  bool periodic_sides = false;
  bool side_walls_move = true;
  double gravity = 1;
  double tilt = 0;  ///< degrees by which the cell leans, x downhill: g = (sin, -cos) of it

  std::optional<std::size_t> n_beads;  ///< absent only with a trajectory start
  double radius = 0.5, mass = 1;
  double inertia_factor = 0.5;  ///< I = factor m R^2: disc 1/2, sphere 2/5
  ContactSpec bead, wall;

  Drive drive;
  bool comoving = true;  ///< false: beads at rest when the plate starts at full speed

  StartKind start = StartKind::crystal_a;
  std::uint64_t seed = 1;
  std::filesystem::path from;  ///< trajectory start
  std::size_t frame = 0;
  double rest_energy = 1e-12;  ///< kinetic energy per bead that counts as rest, m g sigma
  double settle_limit = 100;   ///< t0

  double steps_per_contact = 50;
  std::int64_t discard = 10, cycles = 200;
  int phases = 20;
  Scale scale;
};

/// Reads a scene. A key `preset` names one of preset_names(); the file's own keys win over it.
/// \param assignments "section.key=value", over all else
/// \throws InputError if the file is missing; ConfigError naming file, line, key, value and bound
Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& assignments = {});
/// The same from text.
Scene read_scene_text(const std::string& text, const std::string& name,
                      const std::vector<std::string>& assignments = {});

std::vector<std::string> preset_names();

}  // namespace twincell::sim
