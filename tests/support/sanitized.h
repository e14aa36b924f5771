#pragma once

/// 1 where a sanitizer brings its own malloc, which takes memory and time of its own. gcc says so by names, clang by
/// features.
#ifdef __has_feature
#define MOMA_SANITIZED (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer))
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MOMA_SANITIZED 1
#else
#define MOMA_SANITIZED 0
#endif
