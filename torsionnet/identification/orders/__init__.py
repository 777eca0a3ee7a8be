"""Orders as measurements of a fit: measured lines, the model behind them and their weighted residuals."""
