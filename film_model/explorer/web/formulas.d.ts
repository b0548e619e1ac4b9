/** The formulas that film_model/explorer/formulas.py records; their names are in the data of the page. */
declare const FORMULAS: Record<string, (...values: any[]) => Record<string, any>>;
