#include "tests/project/definitions.h"

#include <gmock/gmock.h>

namespace flextip {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Definitions, AreOneForEachNameInThisTree) {
  SourceTree tree = ReadSourceTree(FLEXTIP_SOURCE_DIR);
  tree.erase("bench/vision/peer_no_visp.cpp");             // built in the place of peer_visp.cpp
  tree.erase("batch/ranks_without_mpi.cpp");               // in the place of ranks.cpp
  tree.erase("apps/demo/left_out.cpp");                    // in the place of simulate/serve.cpp
  tree.erase("live/openigtlink/without_openigtlink.cpp");  // in the place of client and server
  tree.erase("live/page/without_websocketpp.cpp");         // in the place of server
  tree.erase("live/dds/without_dds.cpp");                  // in the place of node.cpp
  ASSERT_TRUE(tree.contains("core/pose.h"));
  EXPECT_THAT(DoubleDefinitions(tree), IsEmpty());
}

std::vector<std::string> NamesIn(const std::string& text) {
  std::vector<std::string> names;
  for (const Definition& definition : DefinitionsOf(text)) names.push_back(definition.name);
  return names;
}

TEST(Definitions, AreFullyQualified) {
  EXPECT_THAT(
      NamesIn("namespace a::b {\nstruct X final : Y { int z = f(); };\n}\nenum class E { k };"),
      ElementsAre("a::b::X", "E"));
  EXPECT_THAT(NamesIn("namespace a { template <class T> class X<T*> {}; union U {}; }"),
              ElementsAre("a::X<T*>", "a::U"));
  EXPECT_THAT(NamesIn("struct X;\nenum E : int;\nnamespace b = a;\nint f(int);\nusing A = X;"),
              IsEmpty());
}

TEST(Definitions, OfFunctionsHaveTheirParametersTypes) {
  EXPECT_THAT(NamesIn("inline int F(const A& a, std::vector<int> = {}, double) { return G({1}); }"),
              ElementsAre("F(const A &, std :: vector < int >, double)"));
  EXPECT_THAT(
      NamesIn("X::X(int a) : b_{a}, c_(a) { if (a) { } }\nint X::Get() const { return 1; }"),
      ElementsAre("X::X(int)", "X::Get() const"));
  EXPECT_THAT(
      NamesIn("Pose operator*(const Pose& a, const Pose& b) {}\nbool X::operator()(int i) {}"),
      ElementsAre("operator*(const Pose &, const Pose &)", "X::operator()(int)"));
  EXPECT_THAT(NamesIn("template <> const char* Name<2>(int index) {}"),
              ElementsAre("Name<2>(int) template"));
  EXPECT_THAT(NamesIn("template <int N>\ntypename A<N>::M A<N>::Get() const {}\nint main() try {} "
                      "catch (...) {}"),
              ElementsAre("A<N>::Get() const template"));
}

TEST(Definitions, LeaveOutTheInsideOfFilesAndVariables) {
  EXPECT_THAT(
      NamesIn("namespace {\nstruct X {};\nvoid F() {}\n}\nstatic void G() {}\nint main() {}"),
      IsEmpty());
  EXPECT_THAT(
      NamesIn("const std::map<int, int> kA{{1, 2}};\nconst auto f = [](int a) { return a; };\n"
              "#define M(x) { x }\n// struct C {};\nconst char* s = \"struct S {\";"),
      IsEmpty());
}

TEST(Definitions, InTwoFilesAreSeen) {
  const SourceTree tree{{"tests/a.cpp", "namespace f {\nstruct X {};\n}"},
                        {"tests/b.cpp", "namespace f {\n\nstruct X {};\nvoid G(int a) {}\n}"},
                        {"tests/c.cpp", "namespace f { void G(int) {} void G(double) {} }"}};
  EXPECT_THAT(DoubleDefinitions(tree), ElementsAre("f::G(int): tests/b.cpp:4, tests/c.cpp:1",
                                                   "f::X: tests/a.cpp:2, tests/b.cpp:3"));
}

}  // namespace
}  // namespace flextip
