// SPDX-License-Identifier: GPL-3.0-or-later
// Contact problems as text of Siconos: every storage, read from texts put together by hand, and what is refused.
#include "formats/contact_problem/siconos_dat.hpp"

#include "../support/fclib_files.hpp"
#include "../support/run_program.hpp"
#include "../support/spoilt.hpp"

#include <doctest/doctest.h>

#include <sstream>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// As the writer of Siconos has them, but for the digits of sparse entries (%g there), enough here to come back.
std::string dense_text(const SparseMatrix& matrix) {
  std::ostringstream text;
  text.precision(17);
  text << "0\n" << matrix.rows() << "\n" << matrix.cols() << "\n" << matrix.rows() << "\t" << matrix.cols() << "\n";
  const Matrix dense = matrix;  // its data are the columns, a line per column count of entries
  for (Index k = 0; k < dense.size(); ++k)
    text << dense.data()[k] << ((k + 1) % std::max<Index>(matrix.cols(), 1) == 0 ? "\n" : " ");
  return text.str();
}

// Blocks of `height` x 2, those without entries left out.
std::string blocks_text(const SparseMatrix& matrix, Index height) {
  const Matrix dense = matrix;
  const Index rows = matrix.rows() / height, columns = matrix.cols() / 2;
  std::ostringstream sizes, first, column, blocks;
  blocks.precision(17);
  for (Index i = 1; i <= rows; ++i) sizes << height * i << "\t";
  sizes << "\n";
  for (Index j = 1; j <= columns; ++j) sizes << 2 * j << "\t";
  sizes << "\n";
  Index number = 0;
  for (Index i = 0; i < rows; ++i) {
    first << number << "\t";
    for (Index j = 0; j < columns; ++j) {
      const Matrix block = dense.block(height * i, 2 * j, height, 2);
      if (block.isZero(0)) continue;
      column << j << "\t";
      blocks << number++ << "\n";
      for (const double value : block.reshaped()) blocks << value << "\n";
    }
  }
  std::ostringstream text;
  text << "1\n" << matrix.rows() << "\n" << matrix.cols() << "\n" << number << "\n";
  if (number == 0) return text.str();
  text << rows << "\n" << columns << "\n" << sizes.str() << rows + 1 << "\n" << number << "\n";
  text << first.str() << number << "\t\n" << column.str() << "\n" << blocks.str();
  return text.str();
}

std::string sparse_text(const SparseMatrix& matrix, int origin) {
  const Eigen::SparseMatrix<double, Eigen::RowMajor> by_rows = matrix;
  std::ostringstream text;
  text.precision(17);
  text << "2\n" << matrix.rows() << "\n" << matrix.cols() << "\n" << origin << "\n";
  text << "CSparse Version 3.1.9, May 4, 2016.  Copyright (c) Timothy A. Davis, 2006-2016\n";
  text << (origin == 1 ? "triplet: " : origin == 3 ? "csr: " : "") << matrix.rows() << "-by-" << matrix.cols();
  text << ", nzmax: " << matrix.nonZeros() + 3 << " nnz: " << matrix.nonZeros();
  text << (origin == 1 ? "\n" : ", 1-norm: 7152.83\n");
  const auto lines = [&](const char* name, const auto& compressed) {
    for (Index j = 0; j < compressed.outerSize(); ++j) {
      text << "    " << name << " " << j << " : locations " << compressed.outerIndexPtr()[j] << " to "
           << compressed.outerIndexPtr()[j + 1] - 1 << "\n";
      for (typename std::decay_t<decltype(compressed)>::InnerIterator e(compressed, j); e; ++e)
        text << "      " << e.index() << " : " << e.value() << "\n";
    }
  };
  if (origin == 2) lines("col", static_cast<const SparseMatrix::Base&>(matrix));
  if (origin == 3) lines("row", by_rows);
  if (origin == 1)
    for (Index i = matrix.rows() - 1; i >= 0; --i)
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator e(by_rows, i); e; ++e)
        text << "    " << e.row() << " " << e.col() << " : " << e.value() << "\n";
  return text.str();
}

std::string numbers_text(const Vector& values) {
  std::ostringstream text;
  text.precision(24);
  text << std::scientific;
  for (const double value : values) text << "  " << value << " ";
  return text.str() + "\n";
}

using MatrixText = std::function<std::string(const SparseMatrix&, Index height)>;

// Blocks of M are those of a body, of W those of a contact.
struct TextStorage {
  const char* name;
  MatrixText matrix;
};
const std::vector<TextStorage> storages{
    {"dense", [](const SparseMatrix& m, Index) { return dense_text(m); }},
    {"blocks", [](const SparseMatrix& m, Index height) { return blocks_text(m, height); }},
    {"triplets", [](const SparseMatrix& m, Index) { return sparse_text(m, 1); }},
    {"columns", [](const SparseMatrix& m, Index) { return sparse_text(m, 2); }},
    {"rows", [](const SparseMatrix& m, Index) { return sparse_text(m, 3); }}};

std::string local_text(const LocalFrictionProblem& problem, const MatrixText& matrix) {
  return "2\n" + std::to_string(problem.contacts()) + "\n" + matrix(problem.w, 2) + numbers_text(problem.q) +
         numbers_text(problem.friction);
}

std::string global_text(const GlobalFrictionProblem& problem, const std::string& mass, const MatrixText& h) {
  return "2\n" + std::to_string(problem.contacts()) + "\n" + mass + h(problem.h, 3) + numbers_text(problem.f) +
         numbers_text(problem.w) + numbers_text(problem.friction);
}

template <class Problem>
void check_reads_as(const Problem& expected, const std::string& text) {
  const FclibFile file = siconos_from_text(text, "p.dat");
  REQUIRE(std::holds_alternative<Problem>(file.problem));
  CHECK(same_bits(expected, std::get<Problem>(file.problem)));
}

void refused_text(const std::string& text, const Names& names) {
  check_error([&] { siconos_from_text(text, "p.dat"); }, names);
}

std::string by_columns(const SparseMatrix& matrix, Index) { return sparse_text(matrix, 2); }

}  // namespace

TEST_CASE("local and global problems in every storage") {
  const GlobalFrictionProblem global = random_bodies_problem(1, 6, 9);
  const LocalFrictionProblem local = reduce(global);
  for (const TextStorage& storage : storages) {
    CAPTURE(storage.name);
    check_reads_as(local, local_text(local, storage.matrix));
    check_reads_as(local, local_text(local, storage.matrix) + "1\n");  // the flag of old versions
    for (const TextStorage& of_h : storages) {
      CAPTURE(of_h.name);
      check_reads_as(global, global_text(global, storage.matrix(global.mass, 3), of_h.matrix));
    }
  }
}

TEST_CASE("a dense matrix has its columns one after another, as a 4 x 2 H shows") {
  // One body that touches a wall, rows x, y, spin and one more; normal (1, 2, 3, 4), tangent (5, 6, 7, 8).
  const std::string text =
      "2\n1\n0\n4\n4\n4\t4\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n0\n4\n2\n4\t2\n1 2\n3 4\n5 6\n7 8\n"
      "0 0 0 0\n0 0\n0.5\n";
  const auto problem = std::get<GlobalFrictionProblem>(siconos_from_text(text, "p.dat").problem);
  CHECK(Matrix(problem.h).col(0) == Vector::LinSpaced(4, 1, 4));
  CHECK(Matrix(problem.h).col(1) == Vector::LinSpaced(4, 5, 8));
}

TEST_CASE("a local problem is told from a global one of as many rows") {
  // Three contacts of two bodies: M and W both have six rows.
  const GlobalFrictionProblem global = random_bodies_problem(3, 2, 3);
  const LocalFrictionProblem local = reduce(global);
  REQUIRE(global.mass.rows() == local.w.rows());
  check_reads_as(global, global_text(global, dense_text(global.mass), by_columns));
  check_reads_as(local, local_text(local, by_columns));
}

TEST_CASE("problems without contacts, and blocks without entries") {
  GlobalFrictionProblem global = random_bodies_problem(3, 2, 0);
  for (const TextStorage& storage : storages) {
    CAPTURE(storage.name);
    if (std::string(storage.name) == "dense") continue;
    check_reads_as(global, global_text(global, sparse_text(global.mass, 1), storage.matrix));
  }
  check_reads_as(LocalFrictionProblem{SparseMatrix(0, 0), Vector(0), Vector(0)}, "2\n0\n1\n0\n0\n0\n\n\n");
}

TEST_CASE("what is written reads back bit for bit, and without the last digits of Siconos") {
  FclibFile file;
  GlobalFrictionProblem global = random_bodies_problem(1, 6, 5);
  global.f[0] = -0.0;
  global.f[1] = 5e-324;
  global.f[2] = 1.7976931348623157e308;
  global.w[0] = 0.1 + 0.2;
  SUBCASE("global") { file.problem = global; }
  SUBCASE("local") { file.problem = reduce(random_bodies_problem(2, 6, 5)); }
  const std::string text = siconos_text(file, "nscdd 1");
  const FclibFile back = siconos_from_text(text, "p.dat");
  REQUIRE(back.problem.index() == file.problem.index());
  if (const auto* expected = std::get_if<GlobalFrictionProblem>(&file.problem))
    CHECK(same_bits(*expected, std::get<GlobalFrictionProblem>(back.problem)));
  else
    CHECK(same_bits(std::get<LocalFrictionProblem>(file.problem), std::get<LocalFrictionProblem>(back.problem)));
  CHECK(siconos_text(back, "nscdd 1") == text);
  std::istringstream lines(text);  // Siconos reads lines of at most 2 046 characters of a sparse matrix
  std::string line;
  for (int k = 0; k < 12 && std::getline(lines, line); ++k) CHECK(line.size() < 200);
}

TEST_CASE("six digits of a sparse matrix are symmetric enough") {
  LocalFrictionProblem local = reduce(random_bodies_problem(5, 6, 9));
  std::ostringstream rounded;  // %g of every entry, as CSparse prints it
  for (Index j = 0; j < local.w.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(local.w, j); e; ++e) {
      rounded.str("");
      rounded << e.value();
      e.valueRef() = std::stod(rounded.str()) * (e.row() > j ? 1 + 1e-6 : 1);
    }
  check_reads_as(local, local_text(local, by_columns));
  local.w.coeffRef(1, 0) += 2e-2 * local.w.coeff(0, 0);
  refused_text(local_text(local, by_columns), {"p.dat: W:", "matrix"});
}

TEST_CASE("problems in space read back bit for bit, as Siconos writes three rows per contact") {
  FclibFile file;
  const GlobalFrictionProblem global = random_spheres_problem(2, 4, 6);
  file.problem = global;
  const auto back = siconos_from_text(siconos_text(file, "nscdd"), "p.dat");
  const auto& problem = std::get<GlobalFrictionProblem>(back.problem);
  CHECK(problem.dimension == 3);
  CHECK(Matrix(problem.h) == Matrix(global.h));
  CHECK(problem.w == global.w);
  file.problem = reduce(global);
  const auto local = siconos_from_text(siconos_text(file, "nscdd"), "p.dat");
  CHECK(Matrix(std::get<LocalFrictionProblem>(local.problem).w) == Matrix(reduce(global).w));
  // Dense, column by column: W_nn = 2, W_t1 = 3, W_t2 = 4.
  const auto one = siconos_from_text("3\n1\n0\n3\n3\n3 3\n2 0 0\n0 3 0\n0 0 4\n-1 0.5 0.25\n0.5\n", "p.dat");
  CHECK(std::get<LocalFrictionProblem>(one.problem).q == (Vector(3) << -1, 0.5, 0.25).finished());
}

TEST_CASE("problems of another kind are named and refused") {
  refused_text("3\n52\n1\n156\n156\n" + std::string(400, ' ') + std::string(120, '1'), {"p.dat:2: contacts"});
  std::string words;
  for (int k = 0; k < 60; ++k) words += "0 ";
  refused_text("5\n1\n0\n5\n5\n5 5\n" + words, {"not supported: rolling friction (1 contacts, dimension 5)"});
  refused_text("4\n1\n0\n4\n4\n4 4\n" + words, {"dimension:", "2 or 3", "met 4"});
  refused_text("1000\n0.0\n", {"dimension:", "from 1 to 6", "met 1000"});
  const LocalFrictionProblem local = reduce(random_bodies_problem(2, 3, 4));
  refused_text(replaced(local_text(local, by_columns), "8\n8\n2\n", "8\n8\n4\n"),
               {"not supported: half of a symmetric matrix"});
}

TEST_CASE("texts that are no problem are refused with their line") {
  const LocalFrictionProblem local = reduce(random_bodies_problem(2, 3, 4));
  const std::string good = local_text(local, by_columns);
  refused_text("", {"p.dat:1:", "met the end of the file"});
  refused_text("x,y,radius\n1,2,3\n", {"p.dat:1: dimension:", "met 'x,y,radius'"});
  refused_text(replaced(good, "2\n4\n", "2\n4.5\n"), {"p.dat:2: contacts:", "met '4.5'"});
  refused_text(replaced(good, "2\n4\n", "2\n1000000000\n"), {"contacts:", "behind"});
  refused_text(replaced(good, "4\n2\n8", "4\n3\n8"), {"p.dat:3: storage of the first matrix:", "from 0 to 2"});
  refused_text(replaced(good, "8-by-8", "8-by-9"),
               {"p.dat:8: sizes of the first matrix:", "'8-by-8,'", "met '8-by-9,'"});
  refused_text(replaced(good, "col 1 ", "col 2 "), {"from 1 to 1", "met 2"});
  refused_text(replaced(good, "col 0 : locations 0 to", "col 0 : locations 1 to"), {"from 0 to 0", "met 1"});
  refused_text(replaced(good, "nnz: ", "nnz: 1"), {"the first matrix:", "140 entries", "met 40"});
  refused_text(replaced(good, "      0 : ", "      8 : "), {"an entry of the first matrix:", "from 0 to 7"});
  refused_text(replaced(good, "      0 : ", "      0 : x"), {"an entry of the first matrix:", "met 'x"});
  refused_text(replaced(good, "      0 : ", "      0 : nan "), {"p.dat:10: "});
  refused_text(good + "0 0\n", {"H: expected"});
  refused_text(good + "7\n", {"from 0 to 1", "met 7"});
  refused_text(good.substr(0, good.size() - 60), {"met the end of the file"});
  const std::string dense = local_text(local, storages[0].matrix);
  refused_text(replaced(dense, "8\t8", "8\t9"), {"columns of the first matrix:", "from 8 to 8", "met 9"});
  const std::string blocks = local_text(local, storages[1].matrix);
  refused_text(replaced(blocks, "2\t4\t6\t8\t", "2\t4\t3\t8\t"), {"ends of block rows of the first matrix"});
  refused_text(replaced(blocks, "2\t4\t6\t8\t", "2\t4\t6\t7\t"), {"8 at last", "met 7"});
  const GlobalFrictionProblem global = random_bodies_problem(2, 3, 4);
  refused_text(replaced(global_text(global, dense_text(global.mass), by_columns), "9\n8\n2\n", "9\n6\n2\n"),
               {"H: expected"});
}

TEST_CASE("every prefix of a text is refused or is a problem by itself") {
  const GlobalFrictionProblem global = random_bodies_problem(2, 2, 2);
  for (const TextStorage& storage : storages) {
    CAPTURE(storage.name);
    const std::string text = global_text(global, storage.matrix(global.mass, 3), storage.matrix);
    for (std::size_t length = 0; length + 40 < text.size(); ++length)
      CHECK_THROWS_AS(siconos_from_text(text.substr(0, length), "p.dat"), Error);
  }
}

TEST_CASE("a file is told by its name") {
  const TemporaryFolder folder;
  const GlobalFrictionProblem global = random_bodies_problem(2, 3, 4);
  write_file(folder / "p.dat", global_text(global, dense_text(global.mass), by_columns));
  write_file(folder / "p.hdf5", raw_global(global).bytes());
  for (const char* name : {"p.dat", "p.hdf5"}) {
    CHECK(same_bits(global, std::get<GlobalFrictionProblem>(read_contact_problem((folder / name).string()).problem)));
    CHECK(same_bits(global, read_global_problem((folder / name).string())));
  }
  write_file(folder / "local.dat", local_text(reduce(global), by_columns));
  check_error([&] { read_global_problem((folder / "local.dat").string()); }, {"global problem"});
}
