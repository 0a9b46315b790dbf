// The readers and the writer of one topic. Private to the node.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "live/dds/domain.h"
#include "live/dds/node.h"

namespace flextip::live {

/// Deletes an entity of DDS and all that was made of it.
class DdsEntity {
 public:
  explicit DdsEntity(DdsHandle entity = 0) : entity_(entity) {}
  ~DdsEntity();
  DdsEntity(DdsEntity&& other) noexcept : entity_(std::exchange(other.entity_, 0)) {}
  DdsEntity& operator=(DdsEntity&& other) noexcept {
    std::swap(entity_, other.entity_);
    return *this;
  }
  DdsHandle get() const { return entity_; }

 private:
  DdsHandle entity_;
};

/// What readers and writers are made with.
struct EndpointPlace {
  DdsHandle participant = 0, waitset = 0;
  bool lockstep = false;
  std::string beside = {};  ///< by BesideOf: what else is read, told to writers
};

/// Returns topics as a reader tells them.
std::string BesideOf(const std::vector<Ros2Topic>& topics);

/// Reads one type.
class Ros2Reader {
 public:
  Ros2Reader(const EndpointPlace& place, const std::string& name, Ros2Type type);

  /// A sample and who wrote it.
  using Take =
      std::function<void(Ros2Type, const void* sample, TimeNs source_ns, DdsInstance participant)>;
  /// Gives all samples that are there.
  void TakeAll(const Take& take);
  /// Looks at the changes since the last call: who is there, and whether the reader asks for more
  /// than a writer offers; then it asks for less.
  void LookAtStatus();
  int Writers() const { return writers_; }
  /// Returns whether the participant has a writer here.
  bool IsWrittenBy(DdsInstance participant) const;

 private:
  void Open(bool reliable, bool durable);
  DdsInstance ParticipantOf(DdsInstance writer);

  EndpointPlace place_;
  Ros2Type type_;
  DdsEntity topic_, reader_;
  bool reliable_ = true, durable_ = false;
  int writers_ = 0;
  std::map<DdsInstance, DdsInstance> participants_;  // of writers
};

class Ros2Writer {
 public:
  Ros2Writer(const EndpointPlace& place, const std::string& name, Ros2Type type);

  Ros2Type type() const { return type_; }
  /// Returns false where the library does not take it now.
  bool Write(const void* sample) const;
  void LookAtStatus();
  int Readers() const { return readers_; }
  /// Returns whether those readers of `other`'s topic that tell of reading this one too are known
  /// here: others' endpoints become known in no certain order.
  bool KnowsReadersOf(const Ros2Writer& other) const;
  bool WaitForReaders(std::chrono::nanoseconds patience) const;

 private:
  std::string name_;
  Ros2Type type_;
  DdsEntity topic_, writer_;
  int readers_ = 0;
};

}  // namespace flextip::live
