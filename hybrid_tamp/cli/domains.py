"""The verb that lists what is installed: domains."""

from hybrid_tamp.cli.console import print_json, show
from hybrid_tamp.cli.options import JsonOption


def domains(as_json: JsonOption = False) -> None:
    """List the domains that are installed."""
    from hybrid_tamp.verbs.domains import list_domains

    found = list_domains()
    if as_json:
        from hybrid_tamp.report.domain_documents import domains_document

        print_json(domains_document(found))
    else:
        from hybrid_tamp.report.tables import domains_table

        show(domains_table(found))
