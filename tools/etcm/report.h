// What `mesh` and `replay` tell about the mesh they wrote.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "etcm/files/mesh_image.h"
#include "etcm/mesh.h"
#include "mesher.h"

namespace etcm::cli {

// Members of a JSON object: name, value as JSON text.
using Members = std::vector<std::pair<std::string, std::string>>;

std::string json_number(double value);
// One object on one line.
std::string json_object(const Members& members);

// `least` as in lower_bound.h.
Members describe_mesh(const Meshed& meshed, const files::MeshImage& image, std::uint64_t least,
                      const std::string& policy);

// For people.
std::string summary(const Meshed& meshed, const files::MeshImage& image, std::uint64_t least);

}  // namespace etcm::cli
