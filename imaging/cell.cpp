#include "imaging/cell.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <initializer_list>
#include <string_view>

#include "analysis/trajectory/atomic_file.hpp"

namespace twincell {

namespace {

/// One table of the file; complaints name file, line and key.
class Section {
 public:
  Section(const toml::table& root, std::string file, std::string name,
          std::initializer_list<std::string_view> keys)
      : file_(std::move(file)), name_(std::move(name)) {
    const toml::node* node = root.get(name_);
    if (node == nullptr) return;
    table_ = node->as_table();
    if (table_ == nullptr) throw ConfigError(where(*node, ""), "must be a table.");
    for (const auto& [key, value] : *table_)
      if (std::find(keys.begin(), keys.end(), key.str()) == keys.end()) {
        std::string known;
        for (const std::string_view k : keys) known += (known.empty() ? "" : ", ") + std::string(k);
        throw ConfigError(where(value, std::string(key.str())), "is not a key; there are: " + known + ".");
      }
  }

  std::optional<double> number(const std::string& key, std::optional<double> lower = {},
                               bool open_lower = false) const {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    const std::optional<double> value = node->is_number() ? node->value<double>() : std::nullopt;
    if (!value) throw ConfigError(where(*node, key), "must be a number.");
    require_range(where(*node, key), *value, lower, std::nullopt, open_lower);
    return value;
  }
  std::optional<int> whole_number(const std::string& key, int most) const {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    if (!node->is_integer()) throw ConfigError(where(*node, key), "must be a whole number.");
    const auto value = *node->value<std::int64_t>();
    require_range(where(*node, key), static_cast<double>(value), 0, most);
    return static_cast<int>(value);
  }
  std::optional<bool> yes_or_no(const std::string& key) const {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    if (!node->is_boolean()) throw ConfigError(where(*node, key), "must be true or false.");
    return *node->value<bool>();
  }
  std::optional<std::string> word(const std::string& key) const {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    if (!node->is_string()) throw ConfigError(where(*node, key), "must be a text in quotes.");
    return *node->value<std::string>();
  }
  std::optional<PixelPoint> point(const std::string& key) const {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    const toml::array* pair = node->as_array();
    if (pair == nullptr || pair->size() != 2 || !(*pair)[0].is_number() || !(*pair)[1].is_number())
      throw ConfigError(where(*node, key), "must be two numbers, [x, y].");
    const PixelPoint p{*(*pair)[0].value<double>(), *(*pair)[1].value<double>()};
    require_range(where(*node, key), p.x_px, std::nullopt, std::nullopt);
    require_range(where(*node, key), p.y_px, std::nullopt, std::nullopt);
    return p;
  }
  [[nodiscard]] Where where(const std::string& key) const {
    const toml::node* node = find(key);
    return node != nullptr ? where(*node, key) : Where{.file = file_, .key = name_ + "." + key};
  }

 private:
  [[nodiscard]] const toml::node* find(const std::string& key) const {
    return table_ != nullptr ? table_->get(key) : nullptr;
  }
  [[nodiscard]] Where where(const toml::node& node, const std::string& key) const {
    return {.file = file_,
            .line = static_cast<long>(node.source().begin.line),
            .column = static_cast<long>(node.source().begin.column),
            .key = key.empty() ? name_ : name_ + "." + key};
  }
  const toml::table* table_ = nullptr;
  std::string file_;
  std::string name_;
};

Boundary boundary_from(const std::string& word, const Where& where) {
  if (word == "walls") return Boundary::wall;
  if (word == "periodic") return Boundary::periodic;
  if (word == "open") return Boundary::open;
  throw ConfigError(where, fmt::format("is '{}'; it must be \"walls\", \"periodic\" or \"open\".", word));
}

}  // namespace

std::optional<Drive> CellDescription::drive() const {
  const DriveSpec& s = drive_spec;
  if (!s.amplitude && !s.omega && !s.frequency && !s.gamma && !s.k_m && !s.peak_velocity) return std::nullopt;
  return solve_drive(s, 1, Where{.file = {}, .key = "drive"});
}

CellDescription read_cell(const std::filesystem::path& path) {
  const std::string file = path.string();
  CellDescription cell;
  cell.text = read_text_file(path);
  toml::table root;
  try {
    root = toml::parse(cell.text, file);
  } catch (const toml::parse_error& e) {
    throw ConfigError(Where{.file = file,
                            .line = static_cast<long>(e.source().begin.line),
                            .column = static_cast<long>(e.source().begin.column),
                            .key = {}},
                      std::string(e.description()) + ".");
  }
  for (const auto& [key, value] : root)
    if (key != "camera" && key != "cell" && key != "drive" && key != "scale")
      throw ConfigError(Where{.file = file,
                              .line = static_cast<long>(value.source().begin.line),
                              .key = std::string(key.str())},
                        "is not a table of a cell; there are: camera, cell, drive, scale.");

  const Section camera(root, file, "camera",
                       {"pixels_per_sigma", "origin_px", "frames_per_cycle", "first_phase", "bright"});
  cell.pixels_per_sigma = camera.number("pixels_per_sigma", 0, true);
  cell.origin = camera.point("origin_px");
  cell.phase_lock.frames_per_cycle = camera.whole_number("frames_per_cycle", 100000).value_or(0);
  cell.phase_lock.first_phase = camera.whole_number("first_phase", 100000).value_or(0);
  cell.phase_lock.check(camera.where("first_phase"));
  cell.bright = camera.yes_or_no("bright").value_or(false);

  const Section box(root, file, "cell", {"width", "height", "sides"});
  cell.width = box.number("width", 0, true);
  cell.height = box.number("height", 0, true);
  if (const auto sides = box.word("sides")) cell.sides = boundary_from(*sides, box.where("sides"));

  const Section drive(root, file, "drive",
                      {"amplitude", "omega", "frequency", "gamma", "k_m", "peak_velocity"});
  cell.drive_spec = {drive.number("amplitude", 0), drive.number("omega", 0),
                     drive.number("frequency", 0), drive.number("gamma", 0),
                     drive.number("k_m", 0),       drive.number("peak_velocity", 0)};
  const Section scale(root, file, "scale", {"sigma_m", "gravity_m_s2"});
  cell.scale.sigma_m = scale.number("sigma_m", 0, true);
  cell.scale.gravity_m_s2 = scale.number("gravity_m_s2", 0, true);
  return cell;
}

}  // namespace twincell
