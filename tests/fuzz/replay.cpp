// The fuzz targets without libFuzzer: every file of a corpus, then mutations of them, the same ones each time.
// Arguments: corpus folder, number of mutated inputs, and for readers on top of a library that may crash itself: isolated. Then each mutated
// input has a process of its own, and a few may die. What a fuzzer found stays in the corpus, so that it isn't broken again.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

/// What numbers and text are tried with: ends of ranges, and what parsers trip over.
const std::vector<std::string> words{"-1", "0", "1e308", "-1e-308", "nan", "inf", "9223372036854775807", "4294967296", "2147483648", "1e9",
                                     "[", "]", "\"", "\n", ".", "=", "#", "{", "\xff", std::string("\0", 1), "true", "3 0 1 2\n"};

Bytes mutated(Bytes input, const std::vector<Bytes>& corpus, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return n > 0 ? static_cast<std::size_t>(random() % n) : 0; };
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    const std::size_t at = below(input.size() + 1);
    const auto place = input.begin() + static_cast<std::ptrdiff_t>(at);
    switch (below(7)) {
      case 0:  // a bit
        if (at < input.size()) *place ^= static_cast<std::uint8_t>(1u << below(8));
        break;
      case 1:  // a byte
        if (at < input.size()) *place = static_cast<std::uint8_t>(below(256));
        break;
      case 2:  // cut off
        input.erase(place, input.end());
        break;
      case 3: {  // a hole
        const std::size_t length = std::min(below(40), input.size() - at);
        input.erase(place, place + static_cast<std::ptrdiff_t>(length));
        break;
      }
      case 4: {  // a word
        const std::string& word = words[below(words.size())];
        input.insert(place, word.begin(), word.end());
        break;
      }
      case 5: {  // a piece of another input
        const Bytes& other = corpus[below(corpus.size())];
        const std::size_t from = below(other.size()), length = std::min(below(80), other.size() - from);
        const auto piece = other.begin() + static_cast<std::ptrdiff_t>(from);
        input.insert(place, piece, piece + static_cast<std::ptrdiff_t>(length));
        break;
      }
      default: {  // eight bytes: a length or an address of a binary format
        const std::uint64_t values[] = {0, ~std::uint64_t{0}, std::uint64_t{1} << 40, std::uint64_t{1} << 63, random()};
        const std::uint64_t value = values[below(5)];
        for (std::size_t k = 0; k < 8 && at + k < input.size(); ++k) input[at + k] = static_cast<std::uint8_t>(value >> (8 * k));
      }
    }
  }
  return input;
}

/// So that a crash leaves what caused it.
void feed(const Bytes& input, const std::string& keep) {
  std::ofstream(keep, std::ios::binary | std::ios::trunc).write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
  LLVMFuzzerTestOneInput(input.data(), input.size());
}

/// In a child process. False when it dies of a signal, as in a library; what our own code requires ends with SIGILL or an exception, which are told apart.
bool survives(const Bytes& input, const std::string& keep) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(60);
    try {
      feed(input, keep);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "an exception that nobody expects: %s\n", error.what());
      ::_exit(1);
    }
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFSIGNALED(status) && WTERMSIG(status) != SIGILL) return false;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::fprintf(stderr, "a requirement failed; the input is %s\n", keep.c_str());
    std::exit(1);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: replay CORPUS-FOLDER MUTATIONS [isolated]\n");
    return 2;
  }
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<Bytes> corpus;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  if (corpus.empty()) {
    std::fprintf(stderr, "%s holds no inputs\n", argv[1]);
    return 2;
  }
  const std::string keep = "last_input_" + std::filesystem::path(argv[1]).filename().string();
  try {
    for (const Bytes& input : corpus) feed(input, keep);
    std::mt19937_64 random(20240611);
    const long count = std::atol(argv[2]);
    long died = 0;
    for (long i = 0; i < count; ++i) {
      const Bytes input = mutated(corpus[random() % corpus.size()], corpus, random);
      if (argc == 3) feed(input, keep);
      else if (!survives(input, keep)) ++died;
    }
    if (died > 0) std::printf("%ld inputs crashed the library\n", died);
    if (50 * died > count) return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "an exception that nobody expects: %s; the input is %s\n", error.what(), keep.c_str());
    return 1;
  }
  std::filesystem::remove(keep);
  std::printf("%zu inputs of the corpus and %s mutations\n", corpus.size(), argv[2]);
}
