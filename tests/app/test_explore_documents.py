"""Texts of the explore page: one for each tab, with faults that wait for no response, and drafts of closed tabs."""

import json
import threading

import pytest
from support.explore_texts import RIG, Page
from support.patience import PATIENCE, wait_for

from torsionnet.app.cli import main
from torsionnet.app.explore import ExploreServer, api, connections, document, documents, open_documents
from torsionnet.app.explore.api import reply
from torsionnet.app.explore.disk_file import LineEnds
from torsionnet.app.explore.document import NewestTurn, OffsetCounting
from torsionnet.app.explore.session import read_pair
from torsionnet.app.explore.state import RequestError

# k (1/J_1 + 1/J_2) = 400 (12.5 + 3.125) = 6250 = omega^2
NATURAL = 6250**0.5 / (2 * 3.141592653589793)


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "rig.yaml"
    path.write_text(RIG, encoding="utf-8")
    return path


@pytest.fixture
def page(file):
    return Page(open_documents(str(file))[0])


def natural(answer):
    return answer["modes"]["natural"][-1]


class TestTexts:
    def test_every_tab_is_told_the_same_of_the_text_of_the_start(self, page):
        """The first one takes the drivetrain that the page was opened with, the second reads the text itself."""
        first, second = (page.type(page.ask("open", tab)["text"], 1, tab)["faults"] for tab in ("first", "second"))
        assert first == second
        assert "can turn freely" in first[0]["message"]

    def test_a_text_is_opened_typed_and_calculated(self, page):
        opened = page.ask("open")
        assert opened["text"] == RIG
        assert (opened["file"], opened["can_save"], opened["draft"], opened["is_template"]) == (
            "rig.yaml", True, False, False,
        )  # fmt: skip
        assert natural(page.ask("answer")) == pytest.approx(NATURAL, rel=1e-9)
        found = page.type(RIG.replace("400", "1600"))
        assert (found["sound"], found["revision"]) == (True, 1)
        assert [(one.get("code"), one["severity"]) for one in found["faults"]] == [(None, "note")]
        assert [one["name"] for one in found["model"]["parameters"]] == ["k"]
        answer = page.ask("answer")
        assert answer["revision"] == 1
        assert natural(answer) == pytest.approx(2 * NATURAL, rel=1e-9)

    def test_a_faulty_text_keeps_the_last_sound_model(self, page):
        page.type(RIG.replace("400", "1600"), 1)
        broken = RIG.replace("stiffness", "stifness")
        found = page.type(broken, 2)
        assert (found["sound"], found["model"]) == (False, None)
        (fault,) = found["faults"]
        assert broken[fault["from"] : fault["to"]] == "stifness"
        assert (fault["line"], fault["column"], fault["severity"], fault["kind"]) == (6, 48, "error", "unknown-entry")
        assert 'did you mean "stiffness"' in fault["message"]
        assert [fix["edits"][0]["text"] for fix in fault["fixes"]] == ["stiffness"]
        answer = page.ask("answer")
        assert answer["revision"] == 1
        assert natural(answer) == pytest.approx(2 * NATURAL, rel=1e-9)
        assert page.ask("model")["revision"] == 1

    def test_offsets_are_those_of_browsers(self, page):
        broken = RIG.replace("name: rig", "name: rig \U0001d70f").replace("stiffness", "stifness")
        (fault,) = page.type(broken)["faults"]
        assert broken.encode("utf-16-le")[2 * fault["from"] : 2 * fault["to"]].decode("utf-16-le") == "stifness"
        text = "a\U0001d70f\U0001d70b b"
        counting = OffsetCounting(text)
        # Each of the two letters above U+FFFF counts two in the page; inside one of them the next character is meant.
        assert [counting.to_page(at) for at in range(len(text) + 1)] == [0, 1, 3, 5, 6, 7]
        assert [counting.from_page(at) for at in range(9)] == [0, 1, 2, 2, 3, 3, 4, 5, 5]

    def test_two_tabs_have_texts_of_their_own(self, page):
        page.type(RIG.replace("400", "1600"), tab="one")
        assert page.ask("open", "two")["text"] == RIG
        assert natural(page.ask("answer", "one")) == pytest.approx(2 * NATURAL, rel=1e-9)
        assert natural(page.ask("answer", "two")) == pytest.approx(NATURAL, rel=1e-9)
        assert natural(json.loads(reply(page.documents, "api/answer", b"{}"))) == pytest.approx(NATURAL, rel=1e-9)

    def test_an_older_revision_changes_nothing(self, page):
        page.type(RIG.replace("400", "1600"), 5)
        assert page.type(RIG, 4) == {"superseded": True}
        assert natural(page.ask("answer")) == pytest.approx(2 * NATURAL, rel=1e-9)

    def test_a_broken_file_is_opened_to_be_mended(self, file):
        broken = RIG.replace("stiffness", "stifness")
        file.write_text(broken, encoding="utf-8")
        opened, faults = open_documents(str(file), "soft", {"k": "25 N*m/rad"})
        assert ["stifness" in fault.message for fault in faults] == [True]
        page = Page(opened)
        assert page.ask("open")["text"] == broken
        for question in ("model", "answer", "overlay", "values"):
            assert "stifness" in page.ask(question)["refused"][0]
        model = page.type(RIG)["model"]
        assert model["start"]["choice"] == {"configuration": "soft"}
        assert model["start"]["values"] == {"k": "25 N*m/rad"}

    def test_what_the_command_line_asked_for_stays_where_it_fits(self, file):
        page = Page(open_documents(str(file), "stiff", {"k": "900"}, band=(1.0, 30.0))[0])
        before = page.ask("model")
        assert before["start"]["choice"] == {"configuration": "stiff"}
        start = page.type(RIG.replace("stiff:", "hard:"))["model"]["start"]
        assert (start["choice"], start["values"], start["band"]) == ({}, {"k": "900"}, [1.0, 30.0])
        start = page.type(RIG.replace("k:", "c:").replace(": k}", ": c}"), 2)["model"]["start"]
        assert (start["choice"], start["values"]) == ({"configuration": "stiff"}, {})
        assert page.type(RIG, 3)["model"] == before | {"revision": 3}

    def test_responses_asked_for_stay_while_their_nodes_do(self, file):
        pairs = [read_pair("motor/brake"), read_pair("brake/motor"), read_pair("torque(shaft)/motor")]
        page = Page(open_documents(str(file), pairs=pairs)[0])

        def kept(text, revision):
            page.type(text, revision)
            return [str(pair) for pair in page.documents.named("tab").examined().sound.session.pairs]

        assert kept(RIG + "# same\n", 1) == ["motor/brake", "brake/motor", "torque(shaft)/motor"]
        assert kept(RIG.replace("brake", "disc"), 2) == ["torque(shaft)/motor"]
        assert kept(RIG.replace("motor", "disc"), 3) == []

    def test_a_file_named_in_the_text_lies_beside_the_model(self, page, file):
        secret = file.parent.parent / "secret.yaml"
        secret.write_text("torsionnet: 1\nparts: {}\n", encoding="utf-8")
        (file.parent / "link.yaml").symlink_to(secret)
        (file.parent / "own.yaml").write_text("torsionnet: 1\nname: parts\nparts: {}\n", encoding="utf-8")
        for name in ("../secret.yaml", str(secret), "link.yaml"):
            text = f"{RIG}include: [{name}]\n"
            faults = page.type(text, page.ask("open")["revision"] + 1)["faults"]
            (fault,) = [one for one in faults if one["severity"] == "error"]
            assert (fault["kind"], fault["line"]) == ("forbidden-file", 9)
            assert text[fault["from"] : fault["to"]] == name
        assert page.type(f"{RIG}include: [own.yaml]\n", 9)["sound"]


class TestTurns:
    def test_of_several_that_wait_the_newest_runs(self):
        turns, running, go_on, done = NewestTurn(), threading.Event(), threading.Event(), {}

        def slow():
            running.set()
            go_on.wait(PATIENCE)
            return "first"

        def run(name, kind, calculate):
            done[name] = turns.take(kind, calculate)

        threads = [threading.Thread(target=run, args=("first", "answer", slow))]
        threads[0].start()
        assert running.wait(PATIENCE)
        for name, kind in (("second", "answer"), ("overlay", "overlay"), ("third", "answer")):
            threads.append(threading.Thread(target=run, args=(name, kind, lambda name=name: name)))
            threads[-1].start()
            wait_for(lambda kind=kind: turns._waiting.get(kind) == len(threads), pause=0.001)
        threads[1].join(PATIENCE)
        assert done == {"second": None}
        go_on.set()
        for thread in threads:
            thread.join(PATIENCE)
        assert done == {"first": "first", "second": None, "overlay": "overlay", "third": "third"}

    def test_a_failure_frees_the_turn(self):
        turns = NewestTurn()
        with pytest.raises(ZeroDivisionError):
            turns.take("answer", lambda: 1 / 0)
        assert turns.take("answer", lambda: 2) == 2

    def test_faults_and_other_tabs_wait_for_no_response(self, page, monkeypatch):
        running, go_on, found = threading.Event(), threading.Event(), {}

        def slow(session, _):
            if session.base.parameters["k"] == 400:
                running.set()
                go_on.wait(PATIENCE)
            return {"k": session.base.parameters["k"]}

        monkeypatch.setitem(api.QUESTIONS, "api/answer", slow)
        page.ask("open")
        first = threading.Thread(target=lambda: found.update(slow=page.ask("answer")))
        first.start()
        try:
            assert running.wait(PATIENCE)
            for revision in range(1, 11):
                assert page.type(RIG.replace("400", f"{500 + revision}"), revision)["sound"]
            page.type(RIG.replace("400", "1600"), tab="other")
            assert page.ask("answer", "other")["k"] == 1600
            assert page.ask("model")["revision"] == 10
            assert page.ask("schematic")["revision"] == 10
            assert page.ask("motion")["modes"][-1]["frequency_hz"] == pytest.approx((510 / 400) ** 0.5 * NATURAL)
            assert not found
        finally:
            go_on.set()
            first.join(PATIENCE)
        assert found["slow"] == {"k": 400, "revision": 0}
        assert page.ask("answer") == {"k": 510, "revision": 10}

    def test_an_answer_is_made_of_one_text(self, page, monkeypatch):
        """The faults of a text are answered with it, also while a newer one is examined already."""
        held = page.documents.named("tab")
        examined, remade, begun, go_on = held.examined, document.remade_session, threading.Event(), threading.Event()
        newer = threading.Thread(target=examined)

        def slow(base, text, options):
            if "name: newer" in text:
                begun.set()
                go_on.wait(1)
            return remade(base, text, options)

        def overtaken(**options):
            found = examined(**options)
            held.text, held.revision = RIG.replace("name: rig", "name: newer").replace("400", "7"), 2
            newer.start()
            assert begun.wait(PATIENCE)
            return found

        monkeypatch.setattr(document, "remade_session", slow)
        monkeypatch.setattr(held, "examined", overtaken)
        try:
            found = page.type(RIG.replace("400", "1600"), 1)
        finally:
            go_on.set()
            newer.join(PATIENCE)
        assert found == page.type(RIG.replace("400", "1600"), 1, tab="other")


class TestDrafts:
    def test_unsaved_text_of_a_closed_tab_comes_back_once(self, page, monkeypatch):
        page.type(RIG + "# mine\n", 3, "closed")
        assert page.ask("open", "early")["draft"] is False  # the other tab may be open still
        monkeypatch.setattr(document, "ALIVE_SECONDS", 0.0)
        opened = page.ask("open", "new")
        assert (opened["text"], opened["draft"], opened["revision"]) == (RIG + "# mine\n", True, 3)
        monkeypatch.setattr(document, "ALIVE_SECONDS", 5.0)
        assert page.ask("open", "next")["draft"] is False

    def test_a_reloaded_tab_has_its_own_text(self, page):
        opened = page.ask("open", "mine")
        page.type(RIG + "# mine\n", 3, "mine")
        assert page.ask("open", "mine") == opened | {"text": RIG + "# mine\n", "revision": 3, "draft": True}

    def test_stored_text_is_no_draft(self, page, monkeypatch):
        opened = page.ask("open", "closed")
        page.type(RIG + "# mine\n", 3, "closed")
        assert page.ask("store", "closed", text=RIG + "# mine\n", disk=opened["disk"])["stored"]
        monkeypatch.setattr(document, "ALIVE_SECONDS", 0.0)
        opened = page.ask("open", "new")
        assert (opened["text"], opened["draft"]) == (RIG + "# mine\n", False)

    def test_the_tab_longest_unused_goes_and_its_text_stays(self, page):
        page.type(RIG + "# first\n", 1, "first")
        for k in range(documents.MOST_DOCUMENTS):
            page.ask("open", f"tab-{k}")
        assert len(page.documents._documents) == documents.MOST_DOCUMENTS
        assert "first" not in page.documents._documents
        opened = page.ask("open", "first")
        assert (opened["text"], opened["draft"]) == (RIG + "# first\n", True)

    def test_a_tab_that_waits_for_changes_stays(self, page):
        page.documents.named("first").polls = 1
        for k in range(documents.MOST_DOCUMENTS):
            page.ask("open", f"tab-{k}")
        assert "first" in page.documents._documents
        assert "tab-0" not in page.documents._documents

    def test_a_tab_taken_for_closed_has_a_draft_again_once_it_is_typed_in(self, page):
        page.type(RIG + "# first\n", 1)
        page.documents.named("tab").is_handed_on = True
        assert not page.ask("open")["draft"]
        page.type(RIG + "# second\n", 2)
        assert page.ask("open")["draft"]

    def test_pictures_have_a_drivetrain_of_their_own(self, page):
        """One that a response is calculated with keeps results meanwhile."""
        drawn, calculated = [], []
        held = page.documents.named("tab")
        held.drawn("schematic", lambda session: drawn.append(session.base) or {})
        held.calculated("answer", lambda session: calculated.append(session.base) or {})
        assert drawn[0] is not calculated[0]
        assert calculated[0] is held.examined().sound.session.base
        assert drawn[0].parameters == calculated[0].parameters

    def test_a_closed_server_ends_what_waits_for_changes(self, page):
        with ExploreServer(page.documents):
            assert not page.documents.ended.is_set()
        assert page.documents.ended.is_set()

    def test_drafts_are_limited(self, page, monkeypatch):
        monkeypatch.setattr(documents, "MOST_DRAFT_BYTES", 3 * len(RIG))
        monkeypatch.setattr(documents, "MOST_DOCUMENTS", 1)
        for k in range(6):
            page.type(RIG + f"# {k}\n", 1, f"tab-{k}")
        assert list(page.documents._drafts) == ["tab-3", "tab-4"]


class TestFile:
    def test_the_page_follows_another_editor(self, page, file):
        disk = page.ask("open")["disk"]
        assert page.documents.source.disk.changed(disk, lambda: False, 0) is None
        timer = threading.Timer(0.3, lambda: file.write_text(RIG.replace("400", "900"), encoding="utf-8"))
        timer.start()
        found = page.ask("changes", disk=disk)
        assert found["text"] == RIG.replace("400", "900")
        assert found["disk"] != disk
        assert page.ask("changes", disk=disk) == found

    def test_waiting_ends(self, page, monkeypatch):
        disk = page.ask("open")["disk"]
        monkeypatch.setattr(documents, "POLL_SECONDS", 0.3)
        assert page.ask("changes", disk=disk) == {"disk": disk}
        monkeypatch.setattr(documents, "POLL_SECONDS", 2 * PATIENCE)
        found = []
        polls = [
            threading.Thread(target=lambda k=k: found.append(page.ask("changes", f"tab-{k}", disk=disk)))
            for k in range(documents.MOST_POLLS)
        ]
        for poll in polls:
            poll.start()
        wait_for(lambda: page.documents._polls == documents.MOST_POLLS)
        assert page.ask("changes", "one-more", disk=disk) == {"disk": disk, "wait_s": documents.RETRY_SECONDS}
        threading.Timer(0.1, lambda: page.ask("changes", "tab-0", disk="old")).start()
        polls[0].join(PATIENCE)
        assert found == [{"superseded": True}]
        page.documents.ended.set()
        for poll in polls:
            poll.join(PATIENCE)
        assert len(found) == documents.MOST_POLLS

    def test_a_file_that_is_gone_or_no_text(self, page, file, monkeypatch):
        monkeypatch.setattr(documents, "POLL_SECONDS", 0.0)
        disk = page.ask("open")["disk"]
        file.unlink()
        assert page.ask("changes", disk=disk) == {"disk": disk}
        assert page.ask("open", "late")["text"] == RIG
        file.write_bytes(b"name: \xe4\n")
        found = page.ask("changes", disk=disk)
        assert "is no UTF-8 text" in found["refused"][0]
        assert found["disk"] != disk

    @pytest.mark.parametrize(
        ("before", "after"),
        [
            (b"\xef\xbb\xbfa: 1\r\nb: 2\r\n", b"\xef\xbb\xbfa: 1\r\nnew: 0\r\nb: 2\r\n"),
            (b"a: 1\nb: 2\n", b"a: 1\nnew: 0\nb: 2\n"),
            (b"a: 1\rb: 2\r", b"a: 1\rnew: 0\rb: 2\r"),
            (b"a: 1\r\nx: 3\r\nb: 2\n", b"a: 1\r\nnew: 0\r\nx: 3\r\nb: 2\n"),
            (b"", b"new: 0\n"),
        ],
    )
    def test_line_ends_and_mark_stay(self, tmp_path, before, after):
        path = tmp_path / "ends.yaml"
        path.write_bytes(before)
        page = Page(open_documents(str(path))[0])
        opened = page.ask("open")
        assert "\r" not in opened["text"]
        assert "\ufeff" not in opened["text"]
        first, feed, rest = opened["text"].partition("\n")
        assert page.ask("store", text=f"{first}{feed}new: 0\n{rest}", disk=opened["disk"])["stored"]
        assert path.read_bytes() == after

    def test_what_was_not_changed_is_stored_as_it_was(self):
        for text in ("", "\n", "a", "a\r\n", "a\nb\r\nc\r", "\r\r\n\n", "a\r\n\r\nb"):
            ends = LineEnds.of(text, has_mark=False)
            assert ends.given_back(text.replace("\r\n", "\n").replace("\r", "\n")) == text

    def test_values_are_written_into_the_text_of_the_page(self, file):
        file.write_bytes(RIG.replace("\n", "\r\n").encode())
        page = Page(open_documents(str(file))[0])
        found = page.ask("values", values={"k": "500 N*m/rad"})
        assert found["text"] == RIG.replace("400 N", "500 N")


class TestServices:
    def test_services_answer_at_places_of_the_page(self, page):
        at = RIG.index("motor, brake")
        places = [at, RIG.index("node: motor") + 6]
        found = page.ask("references", text=RIG, at=at)["ranges"]
        assert sorted(one["from"] for one in found) == sorted(places)
        edits = page.ask("rename", text=RIG, at=at, name="rotor")["edits"]
        assert [one["text"] for one in edits] == ["rotor"] * len(edits)
        assert "refused" in page.ask("rename", text=RIG, at=0, name="x")
        options = page.ask("complete", text=RIG, at=at + len("motor"))["options"]
        assert [(one["label"], one["from"], one["to"]) for one in options][:1] == [("motor", at, at + len("motor"))]
        for question in ("hover", "definition"):
            assert "refused" not in page.ask(question, text=RIG, at=at)
        assert isinstance(page.ask("format", text=RIG)["edits"], list)
        assert isinstance(page.ask("outline", text=RIG)["items"], list)

    def test_a_table_becomes_a_model(self, page):
        table = "mass\tJ [kg m²]\tk [MNm/rad]\ncyl 1\t0,45\t2,1\nflywheel\t14\t\n"
        for pasted in (table, table.replace("\t", ";"), table.replace(",", ".").replace("\t", ",")):
            text = page.ask("paste", table=pasted)["text"]
            found = page.type(text, page.ask("open")["revision"] + 1)
            assert found["sound"], found["faults"]
            omega = (2.1e6 * (1 / 0.45 + 1 / 14)) ** 0.5
            assert natural(page.ask("answer")) == pytest.approx(omega / (2 * 3.141592653589793), rel=1e-9)
        wrong = page.ask("paste", table="mass;J [kg m²];k [MNm/rad]\ncyl 1;x;2,1\nflywheel;14;")
        assert wrong["refused"][0].startswith('line 2: "x"')

    @pytest.mark.parametrize("text", ["", "one line", "a, b\n1, 2\n", "time;torque\n0;1\n", RIG])
    def test_what_is_no_table(self, page, text):
        assert page.ask("paste", table=text) == {"no_table": True}

    def test_library_models_are_no_tables(self, page):
        from torsionnet.model.files.library import library_models

        for path in library_models().values():
            assert page.ask("paste", table=path.read_text(encoding="utf-8")) == {"no_table": True}, path

    @pytest.mark.parametrize(
        ("path", "entries", "said"),
        [
            ("text", {"text": 5, "revision": 1}, "text is a text"),
            ("text", {"text": "a", "revision": -1}, "revision is a whole number"),
            ("text", {"text": "a", "revision": True}, "revision is a whole number"),
            ("text", {"text": "a"}, "revision is a whole number"),
            ("text", {"text": "\ud800", "revision": 1}, "half of a character"),
            ("text", {"text": "a", "revision": 1, "file": "x"}, '"file" is no entry'),
            ("hover", {"text": "a", "at": "0"}, "at is a whole number"),
            ("hover", {"text": "a", "at": 0, "file": "x"}, '"file" is no entry'),
            ("outline", {"text": "a", "at": 0}, '"at" is no entry'),
            ("store", {"text": "a", "disk": "", "force": 1}, "force is true or false"),
            ("store", {"text": "a", "disk": "x" * 1000}, "disk is too large"),
            ("open", {"file": "/etc/passwd"}, '"file" is no entry'),
        ],
    )
    def test_what_is_no_request(self, page, path, entries, said):
        with pytest.raises(RequestError, match=said):
            page.ask(path, **entries)

    @pytest.mark.parametrize("name", ["../x", "a" * 41, "a b", 5, None, "ä"])
    def test_what_is_no_name_of_a_tab(self, page, name):
        with pytest.raises(RequestError, match="document is a name"):
            page.ask("open", name)


class TestCommand:
    """What the page begins with, with a server that ends at once."""

    @pytest.fixture
    def served(self, monkeypatch):
        found = []
        monkeypatch.setattr(
            "torsionnet.app.cli.commands.tools._serve",
            lambda server, **_: found.append(Page(server.documents).ask("open")),
        )
        return found

    def test_without_a_model_it_is_a_template(self, served, capsys):
        assert main(["explore", "--no-browser"]) == 0
        (opened,) = served
        assert (opened["is_template"], opened["can_save"], opened["file"]) == (True, False, "model.yaml")
        assert "torsionnet explore FILE" in opened["save_hint"]
        assert opened["text"].count("\n") > 30
        assert "Ctrl-Space completes" in opened["text"].splitlines()[2]
        assert "torsionnet check" not in opened["text"]  # which is for a terminal
        assert capsys.readouterr().out == ""

    def test_a_library_model_is_not_changed(self, served):
        assert main(["explore", "amt_rig", "--no-browser"]) == 0
        assert served[0]["can_save"] is False
        assert "library model is not changed" in served[0]["save_hint"]

    def test_a_faulty_file_is_opened_and_its_faults_are_printed(self, served, file, capsys):
        file.write_text(RIG.replace("stiffness", "stifness"), encoding="utf-8")
        assert main(["explore", str(file), "--no-browser", "-c", "soft"]) == 0
        assert served[0]["can_save"] is True
        assert 'did you mean "stiffness"' in capsys.readouterr().err

    def test_bytes_that_are_no_text_open_nothing(self, served, file, capsys):
        file.write_bytes(b"name: \xe4\n")
        assert main(["explore", str(file), "--no-browser"]) == 1
        assert not served
        assert "is no UTF-8 text" in capsys.readouterr().err


def test_limits_are_as_documented():
    assert (documents.MOST_DOCUMENTS, documents.POLL_SECONDS, connections.HEADER_SECONDS) == (16, 20.0, 5.0)
