// SPDX-License-Identifier: Apache-2.0
// Size of a message on the wire.
#pragma once

#include <cstddef>

#include <gtest/gtest.h>

#include "common/bus/dds/cdr.hpp"

namespace handsel::test {

/// Bytes of the CDR form of a sample of the IDL struct; 0 when a bound in the description is above
/// the one of the IDL.
inline std::size_t cdr_size(const MessageType& type, const void* wire) {
  static CdrCodec codec;
  return codec.encode(type, wire).size();
}

/// The same of a message.
template <class M>
std::size_t cdr_size(const M& message) {
  const auto wire = message_type<M>().new_wire();
  std::string why;
  EXPECT_TRUE(message_type<M>().to_wire(&message, 1, wire.get(), why)) << why;
  return cdr_size(message_type<M>(), wire.get());
}

}  // namespace handsel::test
