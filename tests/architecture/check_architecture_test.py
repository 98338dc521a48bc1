#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The checker itself must be able to fail: wrong arrows and a circle planted in a copy are found."""
import importlib.util
import pathlib
import tempfile

spec = importlib.util.spec_from_file_location("check", pathlib.Path(__file__).with_name("check_architecture.py"))
check = importlib.util.module_from_spec(spec)
spec.loader.exec_module(check)

with tempfile.TemporaryDirectory() as folder:
    root = pathlib.Path(folder)
    check.ROOT = root
    planted = {
        "core/base/a.h": '#include "geometry/triangle_mesh.h"\n',
        "core/relief/b.cpp": '#include "thermoform/x.h"\n#include <fstream>\nvoid f() { std::printf("x"); }\n',
        "core/job/c.cpp": '#include "relief/relief.h"\n',
        "core/evidence/fit/h.cpp": '#include "thermoform/x.h"\n',
        "core/evidence/diagnosis/h.cpp": '#include "evidence/models/relief/r.h"\n',
        "core/evidence/models/relief/r.h": "",
        "core/thermoform/x.h": "",
        "core/numerics/sparse/s.h": '#include "numerics/ordering/o.h"\n',
        "core/numerics/ordering/o.h": '#include "numerics/sparse/s.h"\n',
        "native_worker/files/big.h": "",
        "tests/foreign_laboratory/own.h": '#include <Eigen/Core>\n#include "foreign_laboratory/own.h"\n',
        "tests/foreign_laboratory/i.cpp": '#include "thermoform/x.h"\n#include "evidence/virtual_lab.h"\n#include <geometry/x.h>\n#include "foreign_laboratory/../x.h"\n',
        "tests/foreign_laboratory/CMakeLists.txt": "target_link_libraries(x PUBLIC fw_thermoform PRIVATE fw_warnings)\n",
        "web/src/view/d.ts": "import { x } from '../jobs/y';\n",
        "web/src/shared/session/g.ts": "import { x } from '../../crafts/relief/e';\n",
        "web/src/crafts/relief/e.ts": "import { x } from '../zippable/y';\n",
        "web/src/ui/round.ts": "import type { Corner } from './corner';\n",
        "web/src/ui/corner.tsx": "import { round } from './round';\nimport { leaf } from './leaf';\n",
        "web/src/ui/leaf.ts": "",
        "web/src/ui/user.ts": "import './corner';\n",
        "web/src/app/f.ts": "import { x } from '../crafts/relief/e';\n",
    }
    for name, text in planted.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for i in range(check.MAX_FILES):
        (root / f"native_worker/files/n{i}.h").write_text("")
    found = []
    for module in ("base", "relief", "job"):
        found += check.check_sources(root / "core" / module, module, check.CORE[module], is_core=True)
    found += check.check_folders([root / "core", root / "native_worker"])
    found += check.check_foreign(root / "tests/foreign_laboratory")
    found += check.check_web(root / "web/src")
    found += check.check_circles(root / "web/src")
    expected = ["base must not include geometry", "relief must not include thermoform", "<fstream>", "must not print",
                "evidence/fit must not include thermoform", "must not include a craft's model",
                "core/numerics/ordering: circle of folders with core/numerics/sparse",
                "core/numerics/sparse: circle of folders with core/numerics/ordering", "holds 25 files",
                "includes thermoform/x.h", "includes evidence/virtual_lab.h", "includes geometry/x.h", "includes foreign_laboratory/../x.h",
                "links fw_thermoform",
                "view must not import jobs", "shared must not import crafts", "crafts do not know each other",
                "circle: ui/round.ts imports ui/corner.tsx", "circle: ui/corner.tsx imports ui/round.ts"]
    assert len(found) == len(expected), found
    for part in expected:
        assert any(part in problem for problem in found), (part, found)

spec = importlib.util.spec_from_file_location("words", pathlib.Path(__file__).with_name("check_words.py"))
words = importlib.util.module_from_spec(spec)
spec.loader.exec_module(words)
assert set(words.avoided_names("int most_rows = least; // told_s\nauto told_s = \"mend_x\"; edge_way_(mend(f), leastwise(utmost, always));")) == {
    "most_rows", "told_s", "edge_way_", "mend"}

spec = importlib.util.spec_from_file_location("doc_paths", pathlib.Path(__file__).with_name("check_doc_paths.py"))
doc_paths = importlib.util.module_from_spec(spec)
spec.loader.exec_module(doc_paths)
with tempfile.TemporaryDirectory() as folder:
    root = pathlib.Path(folder)
    for name in ("core/base/error.h", "docs/glossary.md"):
        (root / name).parent.mkdir(parents=True)
        (root / name).write_text("")
    document = root / "docs/page.md"
    document.write_text("`core/base/error.h`, `base/error`, `error.h`, `OUT/core/x`, [words](glossary.md#machines), [GRBL](https://github.com/grbl)\n"
                        "`core/base/gone.h`, `base/gone`, `gone.cpp`, [gone](gone.md)\n```\npython3 tests/gone.py\n```\n")
    absent = doc_paths.missing(document, root, {"error.h"})
    assert absent == ["base/gone", "core/base/gone.h", "gone.cpp", "gone.md", "tests/gone.py"], absent
print("planted wrong arrows, words and paths were all found")
