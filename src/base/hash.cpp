#include "base/hash.h"

#ifdef __x86_64__
#include <cpuid.h>
#include <immintrin.h>
#endif

#include <algorithm>
#include <bit>
#include <cstring>

namespace argil {
namespace {

constexpr std::array<std::uint32_t, 64> kRound = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

std::uint32_t load_big_endian(const std::uint8_t* p) {
  return (std::uint32_t{p[0]} << 24) | (std::uint32_t{p[1]} << 16) | (std::uint32_t{p[2]} << 8) | p[3];
}

void compress(std::uint32_t* state, const std::uint8_t* blocks, std::size_t count) {
  for (const std::uint8_t* block = blocks; block != blocks + 64 * count; block += 64) {
    std::array<std::uint32_t, 64> w;
    for (std::size_t t = 0; t < 16; ++t) w[t] = load_big_endian(block + 4 * t);
    for (std::size_t t = 16; t < 64; ++t) {
      const std::uint32_t s0 = std::rotr(w[t - 15], 7) ^ std::rotr(w[t - 15], 18) ^ (w[t - 15] >> 3);
      const std::uint32_t s1 = std::rotr(w[t - 2], 17) ^ std::rotr(w[t - 2], 19) ^ (w[t - 2] >> 10);
      w[t] = w[t - 16] + s0 + w[t - 7] + s1;
    }
    std::array<std::uint32_t, 8> next;
    std::copy_n(state, 8, next.begin());
    auto& [a, b, c, d, e, f, g, h] = next;
    for (std::size_t t = 0; t < 64; ++t) {
      const std::uint32_t S1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
      const std::uint32_t t1 = h + S1 + ((e & f) ^ (~e & g)) + kRound[t] + w[t];
      const std::uint32_t S0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
      const std::uint32_t t2 = S0 + ((a & b) ^ (a & c) ^ (b & c));
      h = g, g = f, f = e, e = d + t1, d = c, c = b, b = a, a = t1 + t2;
    }
    for (std::size_t i = 0; i < 8; ++i) state[i] += next[i];
  }
}

#ifdef __x86_64__

bool has_sha_instructions() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  return __builtin_cpu_supports("sse4.1") && __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 &&
         (b & (1U << 29)) != 0;
}

/// Two words of the state, from high to low: a b e f and c d g h, as the instructions take them.
__attribute__((target("sha,sse4.1"))) void compress_by_processor(std::uint32_t* state,
                                                                 const std::uint8_t* blocks,
                                                                 std::size_t count) {
  auto* words = reinterpret_cast<__m128i*>(state);
  const __m128i swap_bytes = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
  const __m128i badc = _mm_shuffle_epi32(_mm_loadu_si128(words), 0xB1);
  const __m128i hgfe = _mm_shuffle_epi32(_mm_loadu_si128(words + 1), 0x1B);
  __m128i abef = _mm_alignr_epi8(badc, hgfe, 8);
  __m128i cdgh = _mm_blend_epi16(hgfe, badc, 0xF0);
  for (const std::uint8_t* block = blocks; block != blocks + 64 * count; block += 64) {
    const __m128i abef_before = abef;
    const __m128i cdgh_before = cdgh;
    __m128i w[16];  // four words of the schedule each
    for (std::size_t r = 0; r < 16; ++r) {
      if (r < 4) {
        const auto* four = reinterpret_cast<const __m128i*>(block + 16 * r);
        w[r] = _mm_shuffle_epi8(_mm_loadu_si128(four), swap_bytes);
      } else {
        const __m128i sum =
            _mm_add_epi32(_mm_sha256msg1_epu32(w[r - 4], w[r - 3]), _mm_alignr_epi8(w[r - 1], w[r - 2], 4));
        w[r] = _mm_sha256msg2_epu32(sum, w[r - 1]);
      }
      const auto* constants = reinterpret_cast<const __m128i*>(kRound.data() + 4 * r);
      const __m128i added = _mm_add_epi32(w[r], _mm_loadu_si128(constants));
      cdgh = _mm_sha256rnds2_epu32(cdgh, abef, added);
      abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(added, 0x0E));
    }
    abef = _mm_add_epi32(abef, abef_before);
    cdgh = _mm_add_epi32(cdgh, cdgh_before);
  }
  const __m128i feba = _mm_shuffle_epi32(abef, 0x1B);
  const __m128i dchg = _mm_shuffle_epi32(cdgh, 0xB1);
  _mm_storeu_si128(words, _mm_blend_epi16(feba, dchg, 0xF0));
  _mm_storeu_si128(words + 1, _mm_alignr_epi8(dchg, feba, 8));
}

#endif

}  // namespace

Sha256::Sha256(Code code)
    : m_compress(compress),
      m_state{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19},
      m_buffer{} {
#ifdef __x86_64__
  if (code == Code::fastest && has_sha_instructions()) m_compress = compress_by_processor;
#endif
}

Sha256& Sha256::add(std::span<const std::byte> bytes) {
  std::size_t used = m_length % 64;
  m_length += bytes.size();
  while (!bytes.empty()) {
    if (used == 0 && bytes.size() >= 64) {
      const std::size_t whole = bytes.size() / 64;
      m_compress(m_state.data(), reinterpret_cast<const std::uint8_t*>(bytes.data()), whole);
      bytes = bytes.subspan(64 * whole);
      continue;
    }
    const std::size_t take = std::min(bytes.size(), 64 - used);
    std::memcpy(m_buffer.data() + used, bytes.data(), take);
    bytes = bytes.subspan(take);
    used += take;
    if (used == 64) {
      m_compress(m_state.data(), m_buffer.data(), 1);
      used = 0;
    }
  }
  return *this;
}

Sha256& Sha256::add(const std::string& text) {
  return add(std::as_bytes(std::span(text.data(), text.size())));
}

Sha256& Sha256::add(const double* values, std::size_t count) {
  return add(std::as_bytes(std::span(values, count)));
}

std::string Sha256::hex_digest() const {
  Sha256 end = *this;
  const std::uint64_t bits = m_length * 8;
  const std::byte one{0x80};
  const std::byte zero{0};
  end.add(std::span(&one, 1));
  while (end.m_length % 64 != 56) end.add(std::span(&zero, 1));
  std::array<std::byte, 8> length;
  for (std::size_t i = 0; i < 8; ++i) length[i] = static_cast<std::byte>(bits >> (56 - 8 * i));
  end.add(length);
  std::string hex;
  for (const std::uint32_t word : end.m_state)
    for (int shift = 28; shift >= 0; shift -= 4) hex += "0123456789abcdef"[(word >> shift) & 15U];
  return hex;
}

}  // namespace argil
