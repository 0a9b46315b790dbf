// The mapping file makes the same import again.
#include "exchange/mapping_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "recording/recording_writer.h"
#include "tests/exchange/tables.h"
#include "tests/recording/sample_recording.h"

namespace flextip::exchange {
namespace {

using flextip::test_support::ReadText;
using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteText;
using test_support::Digits;
using test_support::KnownMotion;
using test_support::PlanWithSettings;
using testing::HasSubstr;

void WriteTracker(const std::filesystem::path& file) {
  std::string text = "Time [s];Tx;Ty;Tz;q0;q1;q2;q3\n";
  for (const auto& row : KnownMotion()) {
    std::string line = fmt::format(
        "{}.{:09};{};{};{};{};{};{};{}\n", row.t_ns / 1'000'000'000, row.t_ns % 1'000'000'000,
        Digits(1e3 * row.p.x()), Digits(1e3 * row.p.y()), Digits(1e3 * row.p.z()),
        Digits(row.q.w()), Digits(row.q.x()), Digits(row.q.y()), Digits(row.q.z()));
    for (char& c : line)
      if (c == '.') c = ',';
    text += line;
  }
  WriteText(file, text);
}

std::string Failure(const std::filesystem::path& file) {
  try {
    ImportPlan plan;
    ReadMapping(file, plan);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read";
}

TEST(Mapping, MakesTheSameImportAgain) {
  const TemporaryFolder folder;
  WriteTracker(folder / "tracker.csv");
  ImportPlan plan = PlanWithSettings();
  plan.tables = {folder / "tracker.csv"};
  const Imported first = Import(plan);
  WriteImported(folder / "first", first);
  EXPECT_FALSE(first.log.assumed.empty());
  ImportPlan again;
  ReadMapping(folder / "first" / kMappingName, again);
  EXPECT_TRUE(again.tables.empty());
  WriteImported(folder / "second", Import(again));
  for (const char* file : {"import.yaml", "recording.yaml", "em0/data.csv", "em0/sensor.yaml"}) {
    EXPECT_EQ(ReadText(folder / "first" / file), ReadText(folder / "second" / file)) << file;
  }
}

TEST(Mapping, WhatIsToldIsNoLongerAssumed) {
  const TemporaryFolder folder;
  WriteTracker(folder / "tracker.csv");
  ImportPlan plan = PlanWithSettings();
  plan.tables = {folder / "tracker.csv"};
  WriteImported(folder / "first", Import(plan));
  ImportPlan again;
  ReadMapping(folder / "first" / kMappingName, again);
  EXPECT_TRUE(again.assumed.contains("em0.units.length"));
  again.Told("em0.units.length");
  EXPECT_FALSE(Import(again).log.assumed.contains("em0.units.length"));
  WriteText(folder / "more.yaml", "gravity_m_s2: [0, 9.81, 0]\nsensors: {em0: {rate_hz: 40}}\n");
  ReadMapping(folder / "more.yaml", again);
  const Imported imported = Import(again);
  EXPECT_FALSE(imported.log.assumed.contains("gravity_m_s2"));
  EXPECT_FALSE(imported.log.assumed.contains("em0.rate_hz"));
  EXPECT_EQ(imported.recording.em0->rate_hz, 40.0);
  EXPECT_EQ(imported.recording.gravity_m_s2.y(), 9.81);
}

TEST(Mapping, TakesARecordingsSettings) {
  const TemporaryFolder folder;
  Recording recording;
  recording.instrument = {0.6, 0.00238, 0.304, 0.01, -0.1};
  recording.p_RP = {0.1, 0.2, 0.3};
  recording.tolerances["stiffness.scale"] = {0.05};
  WriteRecording(folder.path(), recording);
  ImportPlan plan;
  ReadMapping(folder / "recording.yaml", plan);
  EXPECT_EQ(plan.length_m, 0.6);
  EXPECT_EQ(plan.stiffness_taper, -0.1);
  EXPECT_EQ(plan.p_RP->z(), 0.3);
  EXPECT_EQ(plan.tolerances.at("stiffness.scale"), std::vector<double>{0.05});
}

TEST(Mapping, RelativeFilesCountFromItsFolder) {
  const TemporaryFolder folder;
  WriteText(folder / "m.yaml", "streams: {em0: {file: a.csv, offset_s: -1.25}}\n");
  ImportPlan plan;
  ReadMapping(folder / "m.yaml", plan);
  EXPECT_EQ(plan.streams.at("em0").file, folder / "a.csv");
  EXPECT_EQ(plan.streams.at("em0").offset_ns, -1'250'000'000);
}

TEST(Mapping, RefusesWhatItDoesNotKnow) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text) {
    WriteText(folder / "m.yaml", text);
    return Failure(folder / "m.yaml");
  };
  EXPECT_THAT(refused("format: other\n"), HasSubstr("m.yaml:1: format: found \"other\""));
  EXPECT_THAT(refused("version: 7\n"), HasSubstr("found the unknown version 7"));
  EXPECT_THAT(refused("version: 1\nstream: {}\n"),
              HasSubstr("m.yaml:2: stream: is no key of a mapping file"));
  EXPECT_THAT(refused("streams:\n  em9: {file: a.csv}\n"), HasSubstr("m.yaml:2: streams.em9"));
  EXPECT_THAT(refused("streams:\n  em0:\n    unit: mm\n"), HasSubstr("m.yaml:3: streams.em0.unit"));
  EXPECT_THAT(refused("streams: {em0: {units: {length: deg}}}\n"), HasSubstr("found \"deg\""));
  EXPECT_THAT(refused("streams: {em0: {separator: '|'}}\n"),
              HasSubstr("expected comma, semicolon, tab, blank"));
  EXPECT_THAT(refused("instrument: {length_m: -1}\n"), HasSubstr("expected a number above 0"));
  EXPECT_THAT(refused("sensors: {em0: {distance_m: 1}}\n"), HasSubstr("em0 has no setting"));
}

}  // namespace
}  // namespace flextip::exchange
