"""The verb ``domains``."""

from hybrid_tamp.cli import options
from hybrid_tamp.cli.console import say


def domains(as_json: options.Json = False) -> None:
    """List the installed domains.

    Example: hybrid-tamp domains
    """
    from hybrid_tamp.report.domain_documents import domains_document
    from hybrid_tamp.report.tables import domains_table
    from hybrid_tamp.verbs.domains import list_domains

    found = list_domains()
    say(domains_document(found), as_json, lambda: domains_table(found))
