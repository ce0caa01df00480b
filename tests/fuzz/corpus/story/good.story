start give_mug --seed 3
wait ready within 20s
task give mug
at 1.5s kill -9 spark
expect back spark within 5s
expect speed below 0.5 within 350ms
never cause tracking_error for 2s
stop
