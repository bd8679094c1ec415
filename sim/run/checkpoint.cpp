#include "sim/run/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <type_traits>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/hdf5.hpp"
#include "core/hdf5_open.hpp"
#include "core/provenance.hpp"
#include "core/sha256.hpp"

namespace twincell::sim {

namespace {

constexpr const char* kVersion = "checkpoint_version";

/// Beads, forces and vectors are stored as rows of doubles.
template <class Row>
constexpr hsize_t kColumns = sizeof(Row) / sizeof(double);
template <class Row>
constexpr bool kRowOfDoubles = std::is_trivially_copyable_v<Row> || std::is_same_v<Row, Vec3>;
static_assert(sizeof(Bead) == 12 * sizeof(double) && kRowOfDoubles<Bead>);
static_assert(sizeof(Force) == 6 * sizeof(double) && kRowOfDoubles<Force>);
static_assert(sizeof(Vec3) == 3 * sizeof(double) && kRowOfDoubles<Vec3>);

/// Contact memories in table form.
struct ContactTables {
  std::vector<int> pairs;  ///< i, j
  std::vector<double> values;
};

ContactTables tables_of(const std::vector<ContactMemory>& contacts) {
  ContactTables t;
  for (const ContactMemory& c : contacts) {
    t.pairs.insert(t.pairs.end(), {c.i, c.j});
    t.values.insert(t.values.end(), c.values.begin(), c.values.end());
  }
  return t;
}

/// Common base of Writer and Reader: the digest of all passed data.
class Archive {
 public:
  explicit Archive(hid_t group) : group_(group) {}
  [[nodiscard]] std::string digest() { return digest_.hex(); }

 protected:
  void add(const std::string& name, const void* data, std::size_t size) {
    const std::string head = fmt::format("{} {}\n", name, size);
    digest_.add(head.data(), head.size());
    digest_.add(data, size);
  }
  hid_t group_;

 private:
  Sha256 digest_;
};

class Writer : public Archive {
 public:
  using Archive::Archive;
  template <class Row>
  void rows(const std::string& name, const std::vector<Row>& rows) {
    static_assert(kRowOfDoubles<Row>);
    h5::write_dataset(group_, name, reinterpret_cast<const double*>(rows.data()),
                      {rows.size(), kColumns<Row>});
    add(name, rows.data(), rows.size() * sizeof(Row));
  }
  template <class T>
  void list(const std::string& name, const std::vector<T>& values) {
    h5::write_dataset(group_, name, values.data(), {values.size()});
    add(name, values.data(), values.size() * sizeof(T));
  }
  template <class T>
  void number(const std::string& name, const T& value) {
    list(name, std::vector<T>{value});
  }
  void text(const std::string& name, const std::string& text) {
    h5::write_text(group_, name, text);
    add(name, text.data(), text.size());
  }
};

class Reader : public Archive {
 public:
  using Archive::Archive;
  template <class Row>
  void rows(const std::string& name, std::vector<Row>& rows) {
    const auto numbers = h5::read_dataset<double>(group_, name);
    rows.resize(numbers.size() / kColumns<Row>);
    for (std::size_t k = 0; k < rows.size(); ++k)
      std::copy_n(numbers.data() + k * kColumns<Row>, kColumns<Row>, reinterpret_cast<double*>(&rows[k]));
    add(name, rows.data(), rows.size() * sizeof(Row));
  }
  template <class T>
  void list(const std::string& name, std::vector<T>& values) {
    values = h5::read_dataset<T>(group_, name);
    add(name, values.data(), values.size() * sizeof(T));
  }
  template <class T>
  void number(const std::string& name, T& value) {
    std::vector<T> one;
    list(name, one);
    value = one.empty() ? T{} : one.front();
  }
  void text(const std::string& name, std::string& text) {
    static_cast<void>(h5::read_text(group_, name, text));
    add(name, text.data(), text.size());
  }
};

/// The fields of a checkpoint that need a conversion. pass() lists every field once, for both directions.
struct Plain {
  std::int64_t driven = 0, quiet = 0, reached = 0;
  ContactTables contacts;
  std::vector<std::int64_t> segment_frames;
  std::string segment_digests;    ///< one per line
  std::vector<Vec3> temperature;  ///< all, coarse
  std::vector<double> forces;     ///< RunState::forces_sum; empty if unknown
};

/// Numbers of the forces that do not belong to a wall, and those of each wall.
constexpr std::size_t kOfTheBed = 2 * 9 + 3, kOfAWall = 4;

std::vector<double> numbers_of(const BedForces& f) {
  if (!f.known()) return {};
  std::vector<double> all(f.stress.data(), f.stress.data() + 9);
  all.insert(all.end(), f.kinetic.data(), f.kinetic.data() + 9);
  all.insert(all.end(), {f.in_contact, f.normal_force, f.tangential_force});
  for (std::size_t w = 0; w < f.wall_force.size(); ++w) {
    const Vec3& v = f.wall_force[w];
    all.insert(all.end(), {f.wall_normal_force[w], v.x(), v.y(), v.z()});
  }
  return all;
}

BedForces forces_of(const std::vector<double>& all) {
  if (all.empty()) return {};
  BedForces f;
  std::copy_n(all.data(), 9, f.stress.data());
  std::copy_n(all.data() + 9, 9, f.kinetic.data());
  f.in_contact = all[18], f.normal_force = all[19], f.tangential_force = all[20];
  for (std::size_t at = kOfTheBed; at < all.size(); at += kOfAWall) {
    f.wall_normal_force.push_back(all[at]);
    f.wall_force.emplace_back(all[at + 1], all[at + 2], all[at + 3]);
  }
  return f;
}

template <class Direction, class C, class P>
void pass(Direction& a, C& c, P& plain) {
  a.text("scene", c.scene);
  a.text("provenance", c.provenance);
  a.text("program", c.program);
  a.list("segment_frames", plain.segment_frames);
  a.text("segment_sha256", plain.segment_digests);
  auto& s = c.state;
  a.number("driven", plain.driven);
  a.number("step", s.step);
  a.number("quiet", plain.quiet);
  a.number("settled_time", s.settled.time);
  a.number("settled_energy", s.settled.energy_per_bead);
  a.number("settled_reached", plain.reached);
  a.number("height", s.height);
  a.rows("beads", s.beads);
  a.rows("forces", s.forces);
  a.rows("rim_speeds", s.rim_speeds);
  a.list("contact_pairs", plain.contacts.pairs);
  a.list("contact_values", plain.contacts.values);
  a.list("kernel", s.solver);
  a.list("tracer", s.tracer);
  a.number("looked_at", s.looked_at);
  a.number("touching", s.touching);
  a.rows("temperature", plain.temperature);
  a.number("temperature_steps", s.temperature.steps);
  a.list("forces_sum", plain.forces);
}

Plain plain_of(const Checkpoint& c) {
  Plain p{c.state.driven,
          c.state.quiet,
          c.state.settled.reached,
          tables_of(c.state.contacts),
          {},
          {},
          {c.state.temperature.all, c.state.temperature.coarse},
          numbers_of(c.state.forces_sum)};
  for (const Segment& s : c.segments) {
    p.segment_frames.push_back(s.frames);
    p.segment_digests += s.sha256 + "\n";
  }
  return p;
}

/// Whether the lists agree in the numbers of beads, contacts and segments, as written by this program.
bool agree(const Plain& p, const Checkpoint& c) {
  const std::size_t beads = c.state.beads.size(), contacts = p.contacts.pairs.size() / 2;
  const auto of_each = [&](std::size_t n) { return n == 0 || n == beads; };
  for (std::size_t k = 0; k < p.contacts.pairs.size(); ++k) {
    const int slot = p.contacts.pairs[k];
    // The second index of a pair is negative for a wall.
    if (slot >= static_cast<int>(beads) || (k % 2 == 0 && slot < 0)) return false;
  }
  const bool frames =
      std::all_of(p.segment_frames.begin(), p.segment_frames.end(), [](std::int64_t n) { return n > 0; });
  const auto digests =
      static_cast<std::size_t>(std::count(p.segment_digests.begin(), p.segment_digests.end(), '\n'));
  return frames && digests == p.segment_frames.size() && p.contacts.pairs.size() % 2 == 0 &&
         (contacts == 0 ? p.contacts.values.empty() : p.contacts.values.size() % contacts == 0) &&
         of_each(c.state.forces.size()) && of_each(c.state.rim_speeds.size()) &&
         of_each(c.state.tracer.size()) && (p.temperature.empty() || p.temperature.size() == 2) &&
         (p.forces.empty() ||
          (p.forces.size() >= kOfTheBed && (p.forces.size() - kOfTheBed) % kOfAWall == 0));
}

void take(const Plain& p, Checkpoint& c) {
  c.state.driven = p.driven != 0;
  c.state.quiet = static_cast<int>(p.quiet);
  c.state.settled.reached = p.reached != 0;
  if (p.temperature.size() == 2)
    c.state.temperature.all = p.temperature[0], c.state.temperature.coarse = p.temperature[1];
  c.state.forces_sum = forces_of(p.forces);
  const std::size_t contacts = p.contacts.pairs.size() / 2;
  const std::size_t each = contacts == 0 ? 0 : p.contacts.values.size() / contacts;
  for (std::size_t k = 0; k < contacts; ++k) {
    const auto* values = p.contacts.values.data() + k * each;
    c.state.contacts.push_back(
        {p.contacts.pairs[2 * k], p.contacts.pairs[2 * k + 1], {values, values + each}});
  }
  std::istringstream digests(p.segment_digests);
  for (const std::int64_t frames : p.segment_frames) {
    c.segments.push_back({frames, {}});
    std::getline(digests, c.segments.back().sha256);
  }
}

/// Values of a resolved scene by their full keys.
std::map<std::string, std::string> keys_of(const std::string& toml) {
  std::map<std::string, std::string> keys;
  std::string table, key;
  std::istringstream lines(toml);
  for (std::string line; std::getline(lines, line);) {
    line.erase(0, line.find_first_not_of(' '));
    if (line.empty()) continue;
    const std::size_t equals = line.find(" = ");
    if (line.front() == '[' && equals == std::string::npos && line.back() == ']' &&
        line.find(',') == std::string::npos) {
      table = line.substr(1, line.size() - 2) + ".";
    } else if (equals != std::string::npos) {
      key = (table + line.substr(0, equals));
      keys[key] = line.substr(equals + 3);
    } else {
      keys[key] += line;  // a list that spans several lines
    }
  }
  return keys;
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  h5::quiet();
  AtomicPath place(path, Product::checkpoint());
  h5::Handle file = h5::own(H5Fcreate(place.part().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                            path.string() + ": creating the file");
  h5::write_attribute(file.get(), kVersion, kCheckpointVersion);
  Writer writer(file.get());
  const Plain plain = plain_of(checkpoint);
  pass(writer, checkpoint, plain);
  h5::write_attribute(file.get(), "sha256", writer.digest());
  h5::check(H5Fflush(file.get(), H5F_SCOPE_GLOBAL), path.string() + ": writing to disk");
  file.reset();
  place.commit();
}

Checkpoint read_checkpoint(const std::filesystem::path& path) {
  h5::quiet();
  const auto refuse = [&](const std::string& key, const std::string& complaint) {
    throw InputError({path.string(), 0, 0, key}, complaint);
  };
  const std::string damaged = "the checkpoint is damaged, the run cannot be resumed from it.";
  if (!std::filesystem::exists(path)) refuse("", "the file does not exist.");
  Checkpoint c;
  try {
    const h5::Handle file = h5::open_file(path);
    if (!file) refuse("", damaged);
    const auto version = h5::read_int_attribute(file.get(), kVersion);
    if (version.size() != 1) refuse(kVersion, damaged);
    if (version[0] != kCheckpointVersion)
      refuse(kVersion, fmt::format("the checkpoint is of version {}, this program resumes from version {}.",
                                   version[0], kCheckpointVersion));
    Reader reader(file.get());
    Plain plain;
    pass(reader, c, plain);
    const auto digest = h5::read_text_attribute(file.get(), "sha256");
    if (digest.size() != 1 || digest[0] != reader.digest()) refuse("", damaged);
    if (!agree(plain, c)) refuse("", damaged);
    take(plain, c);
  } catch (const RunError&) {  // HDF5 could not read the file
    refuse("", damaged);
  } catch (const std::bad_alloc&) {  // a size in the file is impossible
    refuse("", damaged);
  } catch (const std::length_error&) {
    refuse("", damaged);
  }
  return c;
}

bool is_of_scene(const std::string& provenance_json, const Scene& scene) {
  const auto provenance = nlohmann::json::parse(provenance_json, nullptr, false);
  return provenance.is_object() && provenance.value("config", nlohmann::json()) == scene.resolved;
}

bool has_other_start(const Scene& scene, const std::string& provenance_json) {
  const auto provenance = nlohmann::json::parse(provenance_json, nullptr, false);
  std::error_code none;
  if (!provenance.is_object() || !std::filesystem::is_regular_file(scene.from, none)) return false;
  const auto inputs = provenance.value("inputs", nlohmann::json::array());
  const std::string now = sha256_of(scene.from);
  return !inputs.empty() && std::none_of(inputs.begin(), inputs.end(),
                                         [&](const auto& i) { return i.value("sha256", "") == now; });
}

void require_same_run(const Scene& scene, const Checkpoint& checkpoint,
                      const std::filesystem::path& checkpoint_name) {
  const std::string remedy = fmt::format("remove {} to start again.", checkpoint_name.string());
  const auto now = keys_of(scene.resolved), then = keys_of(checkpoint.scene);
  const auto value = [](const auto& keys, const std::string& key) {
    const auto at = keys.find(key);
    return at == keys.end() ? std::string("absent") : at->second;
  };
  auto all = now;
  all.insert(then.begin(), then.end());
  for (const auto& [key, unused] : all)
    if (value(now, key) != value(then, key))
      throw ConfigError(scene.where(key), fmt::format("is {}, but {} in the run that is to be resumed; {}",
                                                      value(now, key), value(then, key), remedy));
  if (scene.resolved != checkpoint.scene)
    throw ConfigError({scene.file, 0, 0, ""}, "is not the scene of the run that is to be resumed; " + remedy);
  if (has_other_start(scene, checkpoint.provenance))
    throw ConfigError(scene.where("start.from"),
                      fmt::format("{} has changed since the run began; {}", scene.from.string(), remedy));
  if (checkpoint.program != version_line())
    throw ConfigError(
        {checkpoint_name.string(), 0, 0, ""},
        fmt::format("was written by {}, and this is {}, which may not give the same bits; resume with the "
                    "former, or {}",
                    checkpoint.program, version_line(), remedy));
}

}  // namespace twincell::sim
