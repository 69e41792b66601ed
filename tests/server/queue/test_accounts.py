"""The account of the work done for each person."""

from webdemo.server.queue.turns import Accounts


def test_a_newcomer_starts_where_the_least_served_person_is() -> None:
    accounts = Accounts()
    accounts.served = {"ada": 30.0, "bob": 10.0}
    accounts.meet("eve", ["ada", "bob"])
    assert accounts.served["eve"] == 10.0
    accounts.meet("ada", ["bob"])
    assert accounts.served["ada"] == 30.0
