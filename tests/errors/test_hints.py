"""Messages say what an unknown name may have meant, and what a model refused."""

import math
from typing import Literal

import pytest
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from polyfold.errors import did_you_mean, validation_problem
from polyfold.errors._hints import file_problem, misplaced_truth


class Inner(BaseModel):
    gamma: float = Field(0.5, lt=1)


class Settings(BaseModel):
    model_config = ConfigDict(extra="forbid")

    policy: Inner = Inner()
    color: Literal["red", "blue"] = "red"
    arms: int = 2
    reach: int = 2

    @model_validator(mode="after")
    def _together(self):
        if self.arms > self.reach:
            raise ValueError("arms need reach")
        if self.arms < 0:
            raise ValueError("it has no arms; give one or two")
        return self


@pytest.mark.parametrize(
    ("name", "known", "said"),
    [
        ("casso", ["farthest", "caso"], "did you mean 'caso'?"),
        ("arm", ["arms", "charm", "reach"], "did you mean 'arms' or 'charm'?"),
        ("zzz", ["arms", "reach"], "the known ones are arms, reach"),
        ("zzz", [], "there are none"),
    ],
)
def test_near_names_come_first_and_else_all(name, known, said):
    assert did_you_mean(name, known) == said


def test_where_nothing_is_near_the_caller_may_say_more():
    assert did_you_mean("zzz", ["arms"], "for example arms") == "for example arms"


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"policy": {"gamma": 2}}, "has a bad value for 'policy.gamma': Input should be less than 1; change it"),
        ({"colour": "red"}, "has no setting 'colour'; did you mean 'color'?"),
        ({"arms": 3}, "has values that don't go together: arms need reach; change them"),
        ({"arms": -1}, "can't be used: it has no arms; give one or two"),
    ],
)
def test_what_a_model_refuses_is_named_with_what_to_do(settings, said):
    with pytest.raises(ValidationError) as caught:
        Settings(**settings)
    assert validation_problem(caught.value, Settings.model_fields) == said


class Sentence(BaseModel):
    text: str

    @field_validator("text")
    @classmethod
    def _something(cls, text):
        if not text:
            raise ValueError("it says nothing; write what to do")
        return text


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({}, "has no 'text'; add it"),
        ({"text": ""}, "has a bad value for 'text': it says nothing; write what to do"),
    ],
)
def test_advice_is_given_once_and_a_missing_value_is_called_missing(settings, said):
    with pytest.raises(ValidationError) as caught:
        Sentence(**settings)
    assert validation_problem(caught.value) == said


class Fill(BaseModel):
    share: float = Field(default=0.5, le=1)
    count: int | None = None
    smooth: bool = False


@pytest.mark.parametrize("values", [{"share": True}, {"count": False}])
def test_truth_is_no_number(values):
    assert "is no number; give one" in misplaced_truth(values, Fill.model_fields)


def test_truth_may_stand_where_it_is_asked_for():
    assert misplaced_truth({"smooth": True, "share": 1, "other": True}, Fill.model_fields) == ""


def test_nan_is_called_no_number():
    with pytest.raises(ValidationError) as caught:
        Fill(share=math.nan)
    assert validation_problem(caught.value) == "has a bad value for 'share': nan is no number; give one"


@pytest.mark.parametrize(
    ("raised", "says"),
    [
        (FileNotFoundError(2, "No such file"), "there is no file shirt.png; check the path"),
        (IsADirectoryError(21, "Is a directory"), "shirt.png is a folder; give a file"),
        (NotADirectoryError(20, "Not a directory"), "there can be no shirt.png"),
        (PermissionError(13, "Permission denied"), "shirt.png may not be read or written by you"),
        (OSError(28, "No space left on device"), "the disk is full; make room"),
        (OSError(5, "Input/output error"), "can't be read or written (Input/output error); check the path"),
    ],
)
def test_what_a_file_lacks_is_said_with_what_to_do(raised, says):
    assert says in file_problem(raised, "shirt.png")


def test_what_the_message_names_already_is_left_out():
    with pytest.raises(ValidationError) as caught:
        Settings(policy={"gamma": 2})
    assert validation_problem(caught.value, below=1).startswith("has a bad value for 'gamma':")
    assert validation_problem(caught.value, below=2).startswith("has a bad value: Input")
