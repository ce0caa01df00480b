// SPDX-License-Identifier: Apache-2.0
#include "common/model/object_extent.hpp"

namespace handsel {

std::optional<Shape> primitive_shape(const Primitive& primitive, double margin) {
  const Vector3& size = primitive.size;
  if (!size.allFinite() || !(size.array() > 0).all()) return std::nullopt;
  switch (primitive.kind) {
    case PrimitiveKind::none:
      break;
    case PrimitiveKind::box:
      return Box{size + Vector3::Constant(2 * margin)};
    case PrimitiveKind::cylinder:
      return Cylinder{std::max(size.x(), size.y()) / 2 + margin, size.z() + 2 * margin};
    case PrimitiveKind::sphere:
      return Sphere{size.maxCoeff() / 2 + margin};
  }
  return std::nullopt;
}

Eigen::AlignedBox3d object_extent(const ObjectModel* model, const Primitive& primitive) {
  Eigen::AlignedBox3d box;
  if (model != nullptr)
    for (const Vector3& vertex : model->mesh.vertices) box.extend(vertex);
  if (const auto shape = primitive_shape(primitive); box.isEmpty() && shape) {
    Vector3 half = primitive.size / 2;
    if (primitive.kind == PrimitiveKind::cylinder)
      half.head<2>().setConstant(half.head<2>().maxCoeff());
    if (primitive.kind == PrimitiveKind::sphere) half.setConstant(half.maxCoeff());
    box.extend(half).extend(-half);
  }
  return box;
}

}  // namespace handsel
