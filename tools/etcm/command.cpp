#include "command.h"

#include "etcm/files/file_set.h"

namespace etcm::cli {

void PlacementOptions::add_to(CLI::App& command) {
  command.add_option("--scale", scale_,
                     "Multiply every coordinate by this decimal; the mesh is in the new unit");
  command.add_flag("--round", round_, "Take the nearest integer of every coordinate");
}

files::Placement PlacementOptions::placement() const {
  files::Placement placement;
  placement.round = round_;
  if (scale_.empty()) return placement;
  placement.scale = files::Decimal::parse(scale_);
  if (!placement.scale || placement.scale->is_zero() || placement.scale->is_negative()) {
    throw UsageError("--scale " + scale_ + ": must be a decimal number above 0");
  }
  return placement;
}

Point place_at(const std::string& text, const files::Placement& placement) {
  const std::size_t comma = text.find(',');
  if (comma != std::string::npos) {
    const auto x = files::Decimal::parse(text.substr(0, comma));
    const auto y = files::Decimal::parse(text.substr(comma + 1));
    if (x && y) {
      const auto subunits_x = files::subunits_of(*x, placement);
      const auto subunits_y = files::subunits_of(*y, placement);
      if (subunits_x && subunits_y) return {*subunits_x, *subunits_y};
      throw UsageError("--at " + text + ": is out of range; coordinates run to 16777216");
    }
  }
  throw UsageError("--at " + text + ": must be two decimal numbers, as in --at 12.5,-3");
}

void DomainOption::add_to(CLI::App& command) {
  command
      .add_option("--domain", name_,
                  "What bounds the domain: the convex hull, closed features, or features where "
                  "every node is within them (automatic)")
      ->check(CLI::IsMember({"automatic", "hull", "features"}))
      ->capture_default_str();
}

Exterior DomainOption::exterior() const {
  if (name_ == "hull") return Exterior::hull;
  return name_ == "features" ? Exterior::features : Exterior::automatic;
}

void add_policy_option(CLI::App& command, std::string& name) {
  command.add_option("--policy", name, "Where a feature is split")
      ->check(CLI::IsMember({"default", "paper"}))
      ->capture_default_str();
}

SplitPolicy policy_named(const std::string& name) {
  return name == "paper" ? split_paper : split_default;
}

void print(const std::string& text) {
  files::FileSet standard_output;
  standard_output.add("-", text);
  standard_output.commit();
}

}  // namespace etcm::cli
