// SPDX-License-Identifier: Apache-2.0
// How large an object is, described or not.
#pragma once

#include <optional>

#include "common/geometry/shape.hpp"
#include "common/messages/perception.hpp"
#include "common/model/object_model.hpp"

namespace handsel {

/// The shape of an object without a description, centred in its frame, its surface moved outward by
/// `margin` [m] (a box keeps its corners). nullopt: no primitive, or one without a size. A cylinder
/// that is not round takes the larger diameter, a sphere the largest.
std::optional<Shape> primitive_shape(const Primitive&, double margin = 0);

/// The box around an object in its own frame: of the model's mesh if there is one, else of the
/// primitive. Empty when neither is known.
Eigen::AlignedBox3d object_extent(const ObjectModel*, const Primitive&);

}  // namespace handsel
