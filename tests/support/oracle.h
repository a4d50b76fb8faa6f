// What mesh.h promises, checked by brute force through the public interface alone, with predicates
// of its own. For small meshes: the work grows with triangles times vertices.
#pragma once

#include <gtest/gtest.h>

#include "etcm/mesh.h"

namespace etcm::test {

// etcm::audit(), as an assertion that names the broken rule.
testing::AssertionResult passes_audit(const Mesh& mesh);

// Every triangle counter-clockwise, its circumcircle empty of all vertices, the triangles cover the
// convex hull exactly, every feature is a chain of marked edges and nothing else is marked, and
// every other cocircular tie is broken as the perturbation says.
testing::AssertionResult passes_oracle(const Mesh& mesh);

// Both.
testing::AssertionResult is_sound(const Mesh& mesh);

}  // namespace etcm::test
