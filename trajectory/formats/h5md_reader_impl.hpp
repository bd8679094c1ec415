#pragma once
/// \file
/// State of the reader of H5MD trajectories. h5md_reader.cpp opens the file and reads frames;
/// h5md_reader_info.cpp reads what does not change from frame to frame.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/hdf5.hpp"
#include "trajectory/formats/contact_lists.hpp"
#include "trajectory/formats/foreign_rows.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

struct H5mdReader::Impl {
  std::filesystem::path path;
  TrajectoryInfo info;
  h5::Handle file;
  h5::Series step, time, position, position_sigma, velocity, spin, id, plate_height, phase, cycle,
      temperature, temperature_coarse;
  h5::Series wall_normal_force, wall_force, contact_stress, kinetic_stress, bead_contacts;

  [[noreturn]] void refuse(const std::string& key, const std::string& complaint) const {
    throw InputError({path.string(), 0, 0, key}, complaint);
  }
  /// Reads the number `group`/`name`, if it exists. \throws InputError if it is no number
  bool read_number(const std::string& group, const std::string& name, double& value) const;
  h5::Series force, moment, rim_speed;
  ContactListReader contacts, contact_forces;
  std::optional<ForeignRows> foreign;  ///< of another program

  std::string particle_group() const;
  void open();
  void open_columns(const std::string& group);
  void open_contacts();
  void read_force_mean(std::size_t frame, BedForces& mean) const;
  std::vector<ContactMemory> contacts_of(std::size_t frame) const;
  std::vector<ContactForce> contact_forces_of(std::size_t frame) const;
  void read_box(const std::string& group);
  void read_foreign_box(const std::string& group);
  bool is_planar() const;
  void read_drive();
  void read_parameters();
  void read_conditions();
  void check_gamma();
  void check_layers();
  void require_box(const std::string& group) const;
  void require_plate(const std::vector<std::int32_t>& phases, const std::vector<std::int64_t>& cycles) const;
  void require_rising_time(const std::string& particles) const;
};

/// Opens an object of a file by its path.
inline h5::Handle open_object(hid_t parent, const std::string& path) {
  return h5::own(H5Oopen(parent, path.c_str(), H5P_DEFAULT), "opening " + path);
}

}  // namespace twincell
