#!/usr/bin/python3
"""The checks of the code's form see what they are for: each test breaks one rule in a small tree of its own."""
import json
import subprocess
import tempfile
import unittest
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[3] / "scripts"
TABLE = """| layer | folder | what it holds | may include |
|---|---|---|---|
| 0 | `base` | types | Eigen |
| 1 | `mesh` | tets | base |
| 1 | `linear` | solves | base |
| 2 | `solid` | elements | mesh linear |
| 3 | `sim` | loop | all above |
| 3 | `view` | pictures | all above |
| 7 | `main.cpp` | command line | all |
"""
TREE = {
    "src/README.md": TABLE,
    "src/base/types.h": "",
    "src/mesh/tets.h": '#include "base/types.h"\n#include <vector>\n',
    "src/linear/solve.cpp": "#include <cholmod.h>\n",
    "src/solid/element.h": '#include "mesh/tets.h"\n// #include "sim/step.h"\n',
    "src/sim/step.h": '#include "solid/element.h"\n',
    "src/view/draw.h": "",
    "src/main.cpp": '#include "sim/step.h"\n#include <CLI/CLI.hpp>\n',
    "src/solid/CMakeLists.txt": "argil_module(solid\n  HEADERS element.h\n  DEPENDS base mesh)\n",
    "tests/CMakeLists.txt": "argil_test(unit_mesh SOURCES test_mesh.cpp)\nadd_test(NAME a COMMAND test_a.py)\n",
    "tests/test_mesh.cpp": "",
    "tests/test_a.py": "",
}


class Checks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        for name, text in TREE.items():
            self.write(name, text)
        self.compiled = ["src/main.cpp", "src/linear/solve.cpp", "tests/test_mesh.cpp"]

    def write(self, name, text):
        file = self.root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def run_check(self, script, *arguments):
        run = subprocess.run([SCRIPTS / script, *arguments, "--root", self.root], capture_output=True, text=True)
        self.assertEqual(run.stderr, "")
        return run.returncode, run.stdout

    def expect_layer_breach(self, words):
        code, printed = self.run_check("check_layers.py")
        self.assertEqual(code, 1)
        self.assertEqual(len(printed.splitlines()), 1, printed)
        self.assertIn(words, printed)

    def expect_registered(self, code, words):
        commands = [{"directory": str(self.root), "file": name} for name in self.compiled]
        self.write("build/compile_commands.json", json.dumps(commands))
        found, printed = self.run_check("check_tests_registered.py", self.root / "build")
        self.assertEqual(found, code, printed)
        self.assertIn(words, printed)

    def test_a_tree_that_keeps_the_rules_passes(self):
        self.assertEqual(self.run_check("check_layers.py"), (0, ""))
        self.expect_registered(0, "")

    def test_an_upward_include_is_seen(self):
        self.write("src/mesh/tets.h", '#include "base/types.h"\n#  include "solid/element.h"\n')
        self.expect_layer_breach("mesh may not include solid")

    def test_an_include_of_the_same_layer_is_seen(self):
        self.write("src/linear/a.h", '#include "mesh/tets.h"\n')
        self.expect_layer_breach("linear may not include mesh")

    def test_all_above_does_not_mean_the_same_layer(self):
        self.write("src/sim/a.h", '#include "view/draw.h"\n')
        self.expect_layer_breach("sim may not include view")

    def test_an_include_that_is_no_path_from_src_is_seen(self):
        self.write("src/mesh/a.h", '#include "tets.h"\n')
        self.expect_layer_breach('"tets.h" is no path from src/')

    def test_a_library_outside_its_folder_is_seen(self):
        self.write("src/solid/a.cpp", "#include <cholmod.h>\n")
        self.expect_layer_breach("<cholmod.h>: only linear includes it")

    def test_a_folder_without_a_row_is_seen(self):
        self.write("src/utils/a.h", "")
        self.expect_layer_breach("utils is not in the table")

    def test_a_missing_dependency_is_seen(self):
        self.write("src/solid/CMakeLists.txt", "argil_module(solid\n  DEPENDS base\n  LIBRARIES mesh)\n")
        self.expect_layer_breach("DEPENDS lacks mesh")

    def test_a_missing_dependency_of_a_python_extension_is_seen(self):
        self.write("src/view/bind.cpp", '#include "mesh/tets.h"\n#include "solid/element.h"\n')
        self.write("src/view/CMakeLists.txt", "argil_extension(view\n  SOURCES bind.cpp\n  DEPENDS base mesh)\n")
        self.expect_layer_breach("DEPENDS lacks solid")

    def test_pybind11_is_pythons_alone(self):
        self.write("src/view/bind.cpp", "#include <pybind11/numpy.h>\n")
        self.expect_layer_breach("<pybind11/numpy.h>: only python includes it")

    def test_a_forbidden_dependency_is_seen(self):
        self.write("src/solid/CMakeLists.txt", "argil_module(solid DEPENDS base mesh sim)\n")
        self.expect_layer_breach("DEPENDS on sim")

    def test_a_table_that_points_upward_is_refused(self):
        self.write("src/README.md", TABLE.replace("| tets | base |", "| tets | solid |"))
        run = subprocess.run([SCRIPTS / "check_layers.py", "--root", self.root], capture_output=True, text=True)
        self.assertEqual(run.returncode, 1)
        self.assertIn("may not include `solid`", run.stderr)

    def test_a_test_that_is_not_compiled_is_seen(self):
        self.compiled.remove("tests/test_mesh.cpp")
        self.expect_registered(1, "test_mesh.cpp: is not compiled")

    def test_a_python_test_that_nobody_names_is_seen(self):
        self.write("tests/test_b.py", "")
        self.expect_registered(1, "test_b.py: no CMakeLists.txt names it")

    def test_a_peers_source_may_lack_its_program_but_not_its_name(self):
        self.write("tests/bench/peers/bench_other.cpp", "")
        self.expect_registered(1, "bench_other.cpp: no CMakeLists.txt names it")
        self.write("tests/bench/CMakeLists.txt", "if(OTHER_FOUND)\n  argil_bench(SOURCES peers/bench_other.cpp)\nendif()\n")
        self.expect_registered(0, "")


if __name__ == "__main__":
    unittest.main()
