"""How a script writes its table."""
import csv


def write_table(file, columns, rows):
    """A CSV file with a line of names, then the rows; its folder is made where it is missing."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with open(file, "w", newline="", encoding="utf-8") as text:
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(rows)
