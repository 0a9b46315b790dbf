// What the address sanitizer is to let pass in the tests that use libopenigtlink's message classes:
// its ArrayBase frees with `delete` what `new[]` gave. flextip itself does not use these classes.
extern "C" const char* __asan_default_options();  // NOLINT(bugprone-reserved-identifier)

extern "C" const char* __asan_default_options() { return "alloc_dealloc_mismatch=0"; }
