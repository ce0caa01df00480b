// SPDX-License-Identifier: Apache-2.0
#include "common/bus/dds/raw_reader.hpp"

#include <dds/ddsi/ddsi_serdata.h>

namespace handsel {
namespace {

class DdsRawReader final : public RawReader {
 public:
  explicit DdsRawReader(dds_entity_t reader) : reader_(reader) {}
  ~DdsRawReader() override { dds_delete(reader_); }

  bool take(RawSample& out) override {
    ddsi_serdata* data = nullptr;
    dds_sample_info_t info{};
    if (dds_takecdr(reader_, &data, 1, &info, DDS_ANY_STATE) <= 0) return false;
    out.stamp = info.source_timestamp;
    out.instance = info.instance_handle;
    out.gone = !info.valid_data;
    out.cdr.resize(info.valid_data ? ddsi_serdata_size(data) : 0);
    if (info.valid_data) ddsi_serdata_to_ser(data, 0, out.cdr.size(), out.cdr.data());
    ddsi_serdata_unref(data);
    return true;
  }

 private:
  dds_entity_t reader_;
};

}  // namespace

std::unique_ptr<RawReader> make_raw_reader(dds_entity_t reader) {
  return std::make_unique<DdsRawReader>(reader);
}

}  // namespace handsel
