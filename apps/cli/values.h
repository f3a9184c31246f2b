// What options may be told, checked as they are read: a refusal is one sentence that says what is wanted.
#pragma once

#include <CLI/CLI.hpp>

namespace coif::cli {

/// A finite number from `least` to `most`. CLI::Range lets "nan" pass and writes bounds out to 300 digits.
CLI::Validator number(double least, double most);
/// A finite number above 0, `most` at most.
CLI::Validator numberAbove0(double most);
/// A whole number from 0 to 2^64 − 1; CLI11 itself takes "-1" for the greatest.
CLI::Validator wholeNumber();
/// A .coif file to write: other commands know a scene by that name.
CLI::Validator sceneOut();

/// ".coif" of "BOB.COIF": in small letters, as the writers take it.
std::string extensionOf(const std::string& path);

}  // namespace coif::cli
