"""The manifests for Kubernetes: valid for its schemas, without rights, and in step with the image and the settings."""

from __future__ import annotations

import re
from copy import deepcopy
from typing import Any

import kubernetes_validate
import pytest
import yaml

from tests.server.lab import ROOT
from webdemo.server.settings import PREFIX, read_settings

FOLDER = ROOT / "docs" / "deploy" / "kubernetes"
DOCKERFILE = (ROOT / "Dockerfile").read_text()


def documents(name: str) -> list[dict[str, Any]]:
    return list(yaml.safe_load_all((FOLDER / name).read_text()))


def patched(whole: Any, patch: Any) -> Any:
    """A strategic merge, as ``kubectl patch`` does it: lists of named things by their names."""
    if isinstance(whole, dict) and isinstance(patch, dict):
        return {k: patched(whole.get(k), patch.get(k)) for k in [*whole, *(set(patch) - set(whole))]}
    if isinstance(whole, list) and isinstance(patch, list) and all("name" in each for each in [*whole, *patch]):
        new = {each["name"]: each for each in patch}
        kept = [patched(each, new.pop(each["name"], None)) for each in whole]
        return [*kept, *new.values()]
    return deepcopy(whole if patch is None else patch)


def deployment(name: str, file: str) -> dict[str, Any]:
    return next(d for d in documents(file) if d["kind"] == "Deployment" and d["metadata"]["name"] == name)


def with_ray() -> dict[str, Any]:
    return patched(deployment("pas-de-deux", "lab.yaml"), *documents("lab-with-ray.yaml"))


WHOLE = [*documents("lab.yaml"), *documents("ingress.yaml"), *documents("ray.yaml"), with_ray()]
PODS = [each["spec"]["template"]["spec"] for each in WHOLE if each["kind"] == "Deployment"]


@pytest.mark.parametrize("found", WHOLE, ids=[f"{d['kind']} {d['metadata']['name']}" for d in WHOLE])
def test_a_manifest_fits_its_schema(found: dict[str, Any]) -> None:
    kubernetes_validate.validate(found, kubernetes_validate.latest_version(), strict=True)


@pytest.mark.parametrize("pod", PODS)
def test_no_container_has_rights_or_writes_to_its_image(pod: dict[str, Any]) -> None:
    user = int(re.search(r"^USER (\d+)", DOCKERFILE, re.MULTILINE)[1])  # type: ignore[index]
    assert pod["securityContext"]["runAsUser"] == user and pod["securityContext"]["runAsNonRoot"] is True
    assert pod["automountServiceAccountToken"] is False and pod["enableServiceLinks"] is False
    volumes = {each["name"] for each in pod["volumes"]}
    for container in pod["containers"]:
        given = container["securityContext"]
        assert given["readOnlyRootFilesystem"] is True and given["allowPrivilegeEscalation"] is False
        assert given["capabilities"] == {"drop": ["ALL"]} and container["resources"]["limits"]["memory"]
        assert {each["name"] for each in container["volumeMounts"]} <= volumes


@pytest.mark.parametrize("whole", [deployment("pas-de-deux", "lab.yaml"), with_ray()])
def test_the_lab_s_settings_are_settings(whole: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    lab = whole["spec"]["template"]["spec"]["containers"][0]
    given = dict(re.findall(rf"({PREFIX}[A-Z_]+)=(\S+)", DOCKERFILE))
    given |= {each["name"]: each["value"] for each in lab["env"] if "value" in each}
    for name, value in given.items():
        if name.startswith(PREFIX):
            monkeypatch.setenv(name, value)
    settings = read_settings()
    settings.check()
    assert {n.removeprefix(PREFIX).lower() for n in given if n.startswith(PREFIX)} <= set(type(settings).model_fields)
    assert settings.exit_when_stuck and settings.accounts
    assert settings.hosts == documents("ingress.yaml")[0]["spec"]["tls"][0]["hosts"]
    assert lab["ports"][0]["containerPort"] == settings.port
    grace = whole["spec"]["template"]["spec"]["terminationGracePeriodSeconds"]
    assert grace > settings.grace_seconds
