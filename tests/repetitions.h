// What tests ask of the sanitizers: how often to repeat a trial that they take statistics of.
#pragma once

namespace flextip {

/// Whether the thread sanitizer is in the program, which has a thread of its own.
#if defined(__SANITIZE_THREAD__)
inline constexpr bool kThreadSanitized = true;
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
inline constexpr bool kThreadSanitized = true;
#else
inline constexpr bool kThreadSanitized = false;
#endif
#else
inline constexpr bool kThreadSanitized = false;
#endif

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif
#else
inline constexpr bool kSanitized = false;
#endif

/// Returns `whole`, or a tenth of it under the address or thread sanitizer: a tenth of the trials
/// runs through the same code, and a trial takes ten times as long there. Bounds must follow from
/// the number.
constexpr int Repetitions(int whole) { return kSanitized ? (whole + 9) / 10 : whole; }

}  // namespace flextip
