"""Command lines whose results scripts/corpus keeps, in groups: those of a group run in sequence, in one folder.

A line that begins with `@` makes files (corpus_files.py); the others are for poecal. `{a|b}` represents a line of each word, and `{}` in the same
line that word; KINDS and the like are lists of words. Text after `#` behind a space is a remark.
"""

import re

WORDS = {
    "KINDS": "pose|mixed|relative|point|component|distance|ball-bar|distance-change|sphere|socket|plane|height|flush|direction",
    "FORMS": "urdf|toml|poe|dh|mdh|hayati|origins|ur|xarm|franka|pal|lerobot|mjcf|sdf|usd|csv|offsets|tf|c",
    "CLOSED": "kuka|fanuc|staubli|yaskawa|abb",
    "SHELLS": "bash|elvish|fish|powershell|zsh",
    "COMMANDS": "init|plan|simulate|watch|calibrate|check|import|hand-eye|tcp|detect|report|export|offsets"
    "|compensate|predict|validate|track|compare|fleet|reproduce|schema|completions|man",
    "LOSSES": "auto|off|huber|cauchy|tukey",
    "ROBOTS": "continuous|extreme_rpy|fixed_between|mimic_column|non_unit_axis|random_origins|scara|seven_axis",
    "RECORDED": "bag|workbook|bag_of_points|bare|leica|log|motive|qualisys|rapid|rokae|script|spatial_analyzer",
    "CHARUCO": "charuco:7x5:36mm:26mm:DICT_4X4_50",
    "TREE": "--instrument eyes=head_camera --instrument chest=torso --target left=left_hand --target right=right_hand",
}

GROUPS = {
    "help": """
        --version
        --help
        -h
        help calibrate
        help fleet report
        {COMMANDS} --help
        man
        man {COMMANDS}
        completions {SHELLS}
        schema
    """,
    "example": """
        @take examples/elbow/*
        @text poecal.toml good.toml force.toml unknown.toml MOC.cfg
        calibrate robot.urdf points.csv --out results
        calibrate robot.urdf points.csv --out verbose --verbose --record operator=A --record serial=4711 --accept 0.5mm,max:1mm
        calibrate robot.toml points.csv --out toml --json
        calibrate robot.urdf points.csv --out base --device-frame base --quiet
        calibrate robot.urdf points.csv --out strict --require good --accept 0.01mm --accept-model calibrated
        calibrate robot.urdf points.csv --out held --fix joints --free *.offset
        calibrate robot.urdf points.csv --out free --free targets --tolerance auto
        calibrate robot.urdf points.csv --out tip --move-tip --report page.html
        calibrate robot.urdf points.csv --out abb --tolerance MOC.cfg --report none
        calibrate robot.urdf points.csv --out stated --sigma-position 0.05mm --held-out 0 --tolerance none
        calibrate robot.urdf points.csv --out plain --method gauss-newton --formulation {screw|screw-offsets|adjoint-offsets} --force
        calibrate robot.urdf points.csv    # into poecal-out
        calibrate robot.urdf points.csv    # into poecal-out-2
        calibrate robot.urdf points.csv --out results    # is there
        calibrate results/calibration.json points.csv --out again
        calibrate --settings good.toml
        calibrate --settings good.toml    # is there
        calibrate --settings force.toml
        calibrate    # by poecal.toml, which is wrong
        calibrate --settings unknown.toml
        check --settings good.toml
        check robot.urdf points.csv
        check robot.urdf points.csv --json
        check robot.urdf
        check robot.urdf --json
        report results/calibration.json --out again.html
        report results/calibration.json --residuals verbose/residuals.csv --out other.html --force
        report verbose/calibration.json --certificate
        @pictures logos
        report results/calibration.json --certificate --out paper.html --record serial=12 --record valid_until=2027-11-28 --logo logos/{gray.png|baseline.jpg}
        validate results/calibration.json points.csv --out check
        validate results/calibration.json points.csv --history none --json --refit device,tool
        validate results/calibration.json points.csv --require good    # its own rows
        simulate results/calibrated.urdf --errors 0deg,0mm --kind point --count 25 --seed 7 --out second
        validate results/calibration.json second/measurements.csv --refit device --require good --accept 0.2mm,max:0.5mm --report check.html --record operator=B
        validate results/calibration.json second/measurements.csv --refit device,tool --accept 0.001mm --out second/check
        report results/calibration.json --out with-history.html
        predict results/calibration.json points.csv
        predict results/calibration.json points.csv --output-frame device --with-uncertainty
        predict robot.urdf points.csv --out nominal.csv
        predict results/calibration.json points.csv --target measured --model calibrated --out target.csv
        compensate results/calibration.json points.csv --out corrected.csv --check
        compensate results/calibration.json points.csv --dry-run --json --model calibrated
        offsets robot.urdf results/calibration.json
        offsets robot.urdf results/calibration.json --json --fix base,tip
        offsets robot.urdf robot.toml --out offsets.txt
        export results/calibration.json --onto robot.urdf --out applied.urdf
        compare results/calibration.json held/calibration.json
        compare results/calibration.json held/calibration.json --json --limit 1mm
        compare results/calibration.json verbose/calibration.json --verbose --out compared.txt
        plan robot.urdf --rows points.csv --kind pose
        plan robot.urdf --rows points.csv --kind point --device-frame base --robot-error 0.3mm,0.1mm --json
        init robot.urdf --out cell
        init robot.urdf --out cell    # is there
        init --hand-eye {in-hand|beside} --out poses-{}
        init --tcp --out touches
        init robot.urdf --columns-from points.csv --json
        init robot.urdf --columns-from points.csv --column x=y[mm] --out mapped
    """,
    "forms": """
        @take examples/elbow/*
        @text motors.json
        simulate robot.urdf --terms harmonics=5e-4 --count 80 --out s
        calibrate s/nominal.urdf s/measurements.csv --out results --quiet
        export results/calibration.json --format {FORMS} --out {}.out
        export results/calibration.json --format {FORMS} --model corrected --out corrected-{}.out
        export results/calibration.json --format {CLOSED}
        export results/calibration.json --format ur --hash calib_12788084448423163542
        export results/calibration.json --format lerobot --motors motors.json
        export results/calibration.json --format urdf --onto robot.urdf --out onto.urdf
        export results/calibration.json --format urdf --out onto.urdf    # is there
        export robot.toml --format {dh|mdh|usd|csv}
        export results/calibration.json --onto robot.urdf
        @replace robot.urdf six.urdf joint1 shoulder_pan_joint
        calibrate six.urdf s/measurements.csv --out no    # no such column
        simulate six.urdf --count 60 --out six
        calibrate six.urdf six/measurements.csv --report none --out six/results
        export six/results/calibration.json --format {ur|pal|origins}
        export robot.urdf --out elbow.toml
        export robot.toml --format urdf
        export results/calibration.json --format {urdf|toml}
        export robot.urdf --offset joint2=1deg --offset joint3=-0.2deg --out offset.urdf
    """,
    "models": """
        @take crates/poecal-testing/data/urdf/*
        @take crates/poecal-testing/data/torso.urdf
        @take crates/poecal-testing/data/calibration_schema_1.*
        @arm {kuka|ur|fanuc|abb}
        @seed robot_toml/{form0|form1|form2|form3|form4|gantry} {}.toml
        @seed urdf/{found-robot-without-a-name|mimic|slide} {}.urdf
        @seed foreign/mjcf arm.xml
        @seed foreign/sdf arm.sdf
        @seed foreign/yaml ur.yaml
        @seed foreign/conf calibration.conf
        @seed calibration/{corrected|gantry|scara|schema_1} {}.json
        @seed pipeline/{elbow|gantry|scara|two_targets} line-{}.toml line-{}.csv
        export {form0|form1|form2|form3|form4|gantry|kuka|ur|fanuc|abb}.toml --format urdf
        export {found-robot-without-a-name|mimic|slide|extreme_rpy|mimic_column|seven_axis}.urdf --format toml
        export {arm.xml|arm.sdf|ur.yaml|calibration.conf} --format {urdf|toml}
        export {corrected|gantry|scara|schema_1}.json --format toml
        check {arm.xml|arm.sdf|ur.yaml|calibration.conf|form4.toml|mimic.urdf|torso.urdf}
        check torso.urdf --tip-link left_hand --json
        predict calibration_schema_1.json calibration_schema_1.csv
        report schema_1.json
        export {corrected|scara}.json --format {mjcf|sdf|toml}
        check line-{elbow|gantry|scara|two_targets}.toml line-{}.csv
        calibrate line-{elbow|gantry|scara|two_targets}.toml line-{}.csv --out {} --report none
    """,
    "kinds": """
        @take examples/elbow/robot.urdf
        simulate robot.urdf --kind {KINDS} --count 120 --held-out-count 10 --out {}
        check {KINDS}/nominal.urdf {}/measurements.csv
        plan {KINDS}/nominal.urdf --rows {}/measurements.csv --kind {}
        calibrate {KINDS}/nominal.urdf {}/measurements.csv --out {}/results
        validate {KINDS}/results/calibration.json {}/held_out.csv --history none --json
        init robot.urdf --kind {KINDS} --count 12 --out {}-cell
        calibrate pose/nominal.urdf pose/measurements.csv --residual spatial --method gauss-newton --out pose/spatial
        calibrate socket/nominal.urdf socket/measurements.csv --socket-distance 50mm --out socket/known
        calibrate height/nominal.urdf height/measurements.csv --contact flush --out height/flush
    """,
    "robots": """
        @take crates/poecal-testing/data/urdf/*
        @take crates/poecal-testing/data/torso.urdf
        simulate {ROBOTS}.urdf --count 60 --out {}
        calibrate {ROBOTS}/nominal.urdf {}/measurements.csv --out {}/results --verbose
        export seven_axis/results/calibration.json --format {franka|xarm|dh|mdh|hayati|origins}
        offsets {scara|seven_axis}/nominal.urdf {}/results/calibration.json
        simulate gantry.urdf --count 60 --out gantry    # joints with names of measured columns
        simulate torso.urdf --target left=left_hand --target right=right_hand --kind point --count 200 --out torso
        calibrate torso/nominal.urdf torso/measurements.csv --target left=left_hand --target right=right_hand --out torso/results
        simulate torso.urdf {TREE} --count 150 --held-out-count 20 --out tree
        check torso.urdf tree/measurements.csv {TREE}
        calibrate torso.urdf tree/measurements.csv {TREE} --out tree/results
        predict tree/results/calibration.json tree/held_out.csv --target left
        validate tree/results/calibration.json tree/held_out.csv --history none
        export tree/results/calibration.json --format {urdf|toml|mjcf}
        check torso.urdf --instrument eyes=head_camra --target left=left_hand
    """,
    "corrections": """
        @take examples/elbow/*
        simulate robot.urdf --terms sag=1e-3,tilt=1e-3,ratio=1e-4,harmonics=2e-4 --count 100 --out made
        simulate robot.urdf --terms backlash=1e-3,payload=1e-5,factors=1e-4 --count 120 --out loaded
        simulate robot.urdf --terms wobble=1e-4,shift=1e-4,runout=1e-4 --kind point --count 120 --out worn
        simulate robot.urdf --terms sag=1e-3,tilt=1e-3 --gravity 1,0,0 --count 80 --out wall
        calibrate made/nominal.urdf made/measurements.csv --corrections {auto|all|off} --out {}
        calibrate made/nominal.urdf made/measurements.csv --corrections sag=2e-3,tilt,ratio --harmonics 1 --out some
        calibrate wall/nominal.urdf wall/measurements.csv --gravity {find|1,0,0} --out wall-{}
        calibrate loaded/nominal.urdf loaded/measurements.csv --factors approach_joint2,payload --corrections backlash,payload --out load
        calibrate worn/nominal.urdf worn/measurements.csv --corrections wobble,shift,runout --out wear
        @change warmth made/measurements.csv warm.csv
        calibrate made/nominal.urdf warm.csv --factors temperature --corrections factors,sag --out warm
        predict auto/calibration.json made/measurements.csv --model {corrected|calibrated} --with-uncertainty
        predict warm/calibration.json made/measurements.csv    # the temperature is absent
        validate auto/calibration.json made/measurements.csv --history none --require good
        export auto/calibration.json --format {urdf|c|toml} --model corrected --out auto.{}
        compensate auto/calibration.json made/measurements.csv --out auto.csv --check
        compensate warm/calibration.json warm.csv --factors temperature=25 --out warm-25.csv
        compare auto/calibration.json off/calibration.json --limit 100mm
        report auto/calibration.json --certificate
        offsets made/nominal.urdf auto/calibration.json
    """,
    "sessions": """
        @take examples/elbow/robot.urdf
        simulate robot.urdf --kind point --count 100 --out s
        @change {outliers|moved|slipped|lost|repeated|ids|stages|sets|half} s/measurements.csv {}.csv
        calibrate s/nominal.urdf outliers.csv --robust {LOSSES} --out robust-{}
        calibrate s/nominal.urdf {moved|slipped}.csv --out repaired-{}
        calibrate s/nominal.urdf {moved|slipped}.csv --repair off --out kept-{}
        calibrate s/nominal.urdf {lost|repeated|ids|sets}.csv --out of-{}
        calibrate s/nominal.urdf lost.csv --strict --out strict
        calibrate s/nominal.urdf stages.csv --train-where stage=1,2 --out stages
        calibrate s/nominal.urdf s/measurements.csv moved.csv --device-frames per-file --out files
        calibrate s/nominal.urdf half.csv --validate moved.csv --out repeated    # rows that are fitted
        simulate s/actual.urdf --errors 0deg,0mm --kind point --count 40 --seed 6 --out other
        calibrate s/nominal.urdf s/measurements.csv --validate other/measurements.csv --device-frames per-file --out judged
        calibrate s/nominal.urdf s/measurements.csv --instrument-noise 10um+5um/m --out noise
        calibrate s/nominal.urdf s/measurements.csv --seed 7 --held-out 0.2 --threads 1 --out seeded
        validate repaired-moved/calibration.json s/measurements.csv --refit auto --history none
        validate robust-auto/calibration.json {moved|slipped}.csv --history none --out check-{}
        check s/nominal.urdf {outliers|moved|lost|repeated}.csv
        compare robust-auto/calibration.json robust-off/calibration.json
    """,
    "recordings": """
        @take examples/elbow/*
        @take examples/howto/*.*
        @text camera.toml reflectors.toml coupled.toml
        @semicolons reflectors.csv german.csv
        calibrate robot.urdf camera.csv --columns camera.toml --out camera
        calibrate robot.urdf reflectors.csv --columns reflectors.toml --out reflectors
        calibrate robot.urdf reflectors.csv --out unmapped
        check robot.urdf reflectors.csv --columns reflectors.toml
        check robot.urdf german.csv
        calibrate robot.urdf points.csv --columns coupled.toml --out coupled
        check robot.urdf joints.xlsx points.txt
        calibrate robot.urdf joints.xlsx points.txt --out tracker
        calibrate robot.urdf joints.xlsx points.txt --out tracker --force --corrections off --seed 2
        check robot.urdf joints.xlsx points.txt --sheet Sheet9
        import robot.urdf joints.xlsx points.txt --out session.csv
        import --settings session.map.toml --out again.csv
        init robot.urdf --columns-from joints.xlsx --json
        calibrate robot.urdf joints.csv take.csv --out mocap
        import robot.urdf joints.csv take.csv --out paired.csv
        check robot.urdf joints.csv take.csv --join {name|rows|time} --json
        calibrate robot.urdf joints.csv take.csv --lag 3s --body Hand --out no
        calibrate robot.urdf moving_joints.csv moving_take.csv --join motion --out moving
        calibrate robot.urdf session.mcap --out bag
        import robot.urdf session.mcap --topic /joint_states --out bag.csv
        @cut session.mcap cut.mcap 60000
        check robot.urdf cut.mcap
        validate tracker/calibration.json joints.xlsx points.txt --history none
        predict tracker/calibration.json joints.xlsx
    """,
    "forms-of-files": """
        @take examples/elbow/robot.urdf
        @seed recorded/{RECORDED} {}.1 {}.2
        @seed mapping/{form0|form1|form2|other|targets|ur10} {}.toml
        @seed measurements/mapped mapped.csv mapped.toml
        @seed measurements/{elbow|scara|semicolons} {}.csv
        @seed joints/ids ids.csv
        @seed messages/blocks blocks.yaml
        @seed messages/lines lines.jsonl
        check robot.urdf {RECORDED}.1 {}.2 --join rows --units mm,deg
        import robot.urdf {RECORDED}.1 {}.2 --join rows --units mm,deg --out {}.csv
        check robot.urdf elbow.csv --columns {form0|form1|form2|other|targets|ur10|mapped}.toml
        check robot.urdf {mapped|scara|semicolons|ids}.csv
        @seed pipeline/scara arm.toml arm.csv
        check arm.toml {mapped|scara|semicolons|ids}.csv
        check arm.toml mapped.csv --columns {mapped|other}.toml
        import arm.toml mapped.csv --columns mapped.toml --out mapped-out.csv
        predict arm.toml ids.csv
        @take examples/howto/lens.csv
        check robot.urdf {blocks.yaml|lines.jsonl}
        check robot.urdf {blocks.yaml|lines.jsonl} --camera lens.csv --markers chessboard:6x5:40mm
    """,
    "joins": """
        @take examples/elbow/robot.urdf
        simulate robot.urdf --kind point --count 60 --out s
        @change joints s/measurements.csv joints.csv
        @change places s/measurements.csv places.csv
        @change places+few s/measurements.csv few.csv
        @change ids s/measurements.csv both.csv
        @change ids+joints s/measurements.csv unnamed.csv
        @change hit+joints s/measurements.csv other.csv
        @change shifted+places s/measurements.csv shifted.csv
        calibrate robot.urdf joints.csv places.csv --out joined
        calibrate robot.urdf places.csv joints.csv --out turned
        calibrate robot.urdf joints.csv {few|shifted}.csv --out joined-{}
        calibrate robot.urdf other.csv places.csv --join rows --out rows
        check robot.urdf joints.csv places.csv --join {name|rows|time|motion}
        check robot.urdf joints.csv joints.csv
        check robot.urdf places.csv
        import robot.urdf joints.csv places.csv --out session.csv
        import robot.urdf joints.csv places.csv --out session.csv    # is there
        validate joined/calibration.json joints.csv places.csv --history none
    """,
    "pictures": """
        @take examples/elbow/robot.urdf
        @take examples/howto/pictures.csv
        @take examples/howto/corners.csv
        @take examples/howto/lens.csv
        simulate robot.urdf --camera {in-hand|beside} --count 14 --seed 3 --errors 0.2deg,0.5mm --out {}
        detect {in-hand|beside} --board {CHARUCO} --out {}.csv
        detect in-hand/picture-001.png --board {CHARUCO} --preview seen
        calibrate {in-hand|beside}/nominal.urdf {}/joints.csv {}.csv --camera {}/cameras.csv --markers {CHARUCO} --out {}-results
        calibrate in-hand/nominal.urdf in-hand/joints.csv in-hand.csv --camera unknown:1280x800 --markers {CHARUCO} --out unknown
        hand-eye {in-hand|beside}/joints.csv {}.csv --camera {} --robot {}/nominal.urdf --lens {}/cameras.csv --markers {CHARUCO}
        validate in-hand-results/calibration.json in-hand/joints.csv in-hand.csv --history none
        calibrate robot.urdf pictures.csv corners.csv --camera lens.csv --markers chessboard:6x5:40mm --out howto
        calibrate robot.urdf pictures.csv corners.csv --camera unknown:1920x1200 --markers chessboard:6x5:40mm --out lens
        calibrate robot.urdf pictures.csv corners.csv --camera lens.csv --markers chessboard:6x5:{50mm|41mm} --out wrong-{}
        calibrate robot.urdf pictures.csv corners.csv --camera lens.csv --markers chessboard:6x5:40mm --fix joints --out held
        calibrate robot.urdf pictures.csv corners.csv --camera howto/calibration.json --markers howto/calibration.json --out found
        check robot.urdf pictures.csv corners.csv --camera lens.csv --markers chessboard:6x5:40mm
        plan robot.urdf --rows pictures.csv --rows corners.csv --camera lens.csv --markers chessboard:6x5:40mm
        hand-eye pictures.csv corners.csv --camera in-hand --robot robot.urdf --lens lens.csv --markers chessboard:6x5:40mm --out hand-eye
    """,
    "boards": """
        @take examples/elbow/robot.urdf
        @take examples/howto/pictures.csv
        @take examples/howto/corners.csv
        @pictures forms
        @text no.png
        @cut forms/gray.png cut.png 200
        @cut forms/baseline.jpg cut.jpg 500
        @seed boards/{aprilgrid|charuco|checkerboard|circlegrid|industrial} {}.yaml
        @seed boards/opencv opencv.xml
        @seed boards/corners board.csv
        @seed boards/points points.csv
        @seed cameras/{kalibr|message|opencv|ros|industrial|found-number-beyond-all} {}.yaml
        @seed cameras/{table|versions} {}.csv
        @seed cameras/visp visp.xml
        detect forms --board chessboard:5x4:25mm --preview seen --out forms.csv
        detect turned --board chessboard:5x4:25mm
        detect forms turned --board chessboard:5x4:25mm    # of two sizes
        detect forms --board chessboard:{4x5|6x4}:25mm
        detect forms/gray.png --board {charuco:5x4:25mm:18mm:DICT_4X4_50|circles:4x3:25mm}
        detect forms/gray.png --board {aprilgrid|charuco|checkerboard|circlegrid|industrial}.yaml
        detect forms/gray.png --board opencv.xml
        detect {no.png|cut.png|cut.jpg|absent.png} --board chessboard:5x4:25mm
        detect forms/gray.png --board chessboard:5
        simulate robot.urdf --camera in-hand --board chessboard:6x5:40mm --count 3 --out chessboard
        simulate robot.urdf --camera in-hand --board circles:4x7:26mm:asymmetric --count 3 --out circles
        simulate robot.urdf --camera in-hand --board aprilgrid:3x2:60mm:0.3 --count 3 --out aprilgrid
        simulate robot.urdf --camera beside --board tags:36h11:50mm --count 3 --out tags
        detect chessboard --board chessboard:6x5:40mm
        detect circles --board circles:4x7:26mm:asymmetric
        detect aprilgrid --board aprilgrid:3x2:60mm:0.3
        detect aprilgrid --board tags:36h11:60mm
        check robot.urdf pictures.csv corners.csv --camera {kalibr.yaml|message.yaml|opencv.yaml|ros.yaml|industrial.yaml|visp.xml} --markers chessboard:6x5:40mm
        check robot.urdf pictures.csv corners.csv --camera {table.csv|versions.csv|versions.csv#2|found-number-beyond-all.yaml} --markers chessboard:6x5:40mm
        @change camera corners.csv left.csv
        check robot.urdf pictures.csv left.csv --camera {table.csv|kalibr.yaml} --markers chessboard:6x5:40mm
        check robot.urdf pictures.csv corners.csv --camera ros.yaml --markers {charuco.yaml|points.csv|board.csv}
        detect --print chessboard:10x7:25mm --out chessboard.{svg|pdf}
        detect --print circles:9x6:25mm --out dots.{svg|pdf}
        detect --print aprilgrid:4x3:40mm:0.3 --out aprilgrid.{svg|pdf}
        detect --print tags:36h11:50mm --out tags.{svg|pdf}
        detect --print chessboard:10x7:25mm --out chessboard.{svg|png}    # is there; no form
        detect --print chessboard:10x7:25mm
        detect --print charuco:5x7:36mm:27mm:DICT_4X4_50:legacy --paper {a3|letter|400x300mm} --out {}.pdf
        detect --print circles:4x11:15mm:asymmetric --out circles.svg
        detect --print charuco:5x7:36mm:27mm:DICT_4X4_50 --measured 179.4mm,251.2mm
        detect --print charuco:5x7:90mm:60mm:DICT_4X4_50 --paper a4 --out large.pdf
        detect --print charuco:5x7:36mm:40mm:DICT_4X4_50
    """,
    "flange": """
        @take examples/elbow/robot.urdf
        @take examples/howto/hand_eye.csv
        @take examples/howto/touches.csv
        hand-eye hand_eye.csv --camera {in-hand|beside} --units mm
        hand-eye hand_eye.csv --camera in-hand --units mm --out hand-eye --frame-names base,flange,eye,board
        hand-eye hand_eye.csv --camera in-hand --units mm --out hand-eye    # is there
        hand-eye hand_eye.csv --camera in-hand --units mm --json --flange base-from-flange --target camera-from-target
        hand-eye hand_eye.csv --camera in-hand --units m
        hand-eye touches.csv --camera in-hand
        tcp touches.csv
        tcp touches.csv --units mm,deg --out tcp --json
        tcp hand_eye.csv --units mm
        tcp robot.urdf
        simulate robot.urdf --kind socket --count 20 --noise 0.02mm,0.01deg --out s
        tcp s/measurements.csv --robot s/nominal.urdf
    """,
    "plan": """
        @take examples/elbow/*
        plan robot.urdf --count 12 --held-out-count 4 --target-offset 60,0,30mm --out joints.csv --report plan.html
        plan robot.urdf --count 10 --kind {pose|distance|relative|plane} --seed 3
        plan robot.urdf --count 10 --criterion {D|A|E|G} --json
        plan robot.urdf --count 10 --workspace 0.5,-0.5,0.5:1.5,0.5,1.5m --margin 5deg,0mm --separation 5deg
        plan robot.urdf --count 10 --floor-height {20mm|-3m}
        plan robot.urdf --count 10 --device 3000,0,500mm --device-half-angle 60deg --distance 0.5m:10m --target-half-angle 60deg --keep-out 1,1,0:2,2,1m
        plan robot.urdf --count 8 --candidates points.csv --targets 3 --target-offset 60,0,30mm --stop 20s --out {script|mod|src|ls}.csv --program visit.{}
        plan robot.urdf --keep-rows joints.csv --replace-rows 2,5 --out better.csv
        plan robot.urdf --count 16 --keep-rows joints.csv --out longer.csv
        plan robot.urdf --count 12 --keep-rows joints.csv --replace-rows 2,5
        plan robot.urdf --count 10 --corrections off --tolerance 1deg,10mm --robot-error 0.3mm,0.1mm
        plan robot.urdf --rows joints.csv --kind point --sigma-position 0.03mm
        watch robot.urdf points.csv --batch
        @change half points.csv half.csv
        @change outliers points.csv wrong.csv
        watch robot.urdf half.csv --batch --json --candidates points.csv
        watch robot.urdf wrong.csv --batch --robot-error 0.05mm
        watch robot.urdf points.csv --target-error 0.4mm
        watch robot.urdf absent.csv --batch
        plan robot.urdf --purpose drift
        plan robot.urdf --count 0
    """,
    "track": """
        @take examples/elbow/robot.urdf
        simulate robot.urdf --kind point --count 60 --seed 3 --out cell
        simulate robot.urdf --kind point --count 60 --seed 3 --device-frame base --out fixed
        calibrate {cell|fixed}/nominal.urdf {}/measurements.csv --out {}/results --quiet
        calibrate fixed/nominal.urdf fixed/measurements.csv --device-frame base --out fixed/based
        track cell/results/calibration.json --plan 8 --repeatability 0.05mm --out witness.csv
        plan cell/nominal.urdf --count 20 --out new.csv
        plan cell/results/calibration.json --purpose drift --count 6 --candidates new.csv --device known --repeatability 0.05mm --out first.csv
        track cell/results/calibration.json cell/measurements.csv --repeatability 0.05mm
        @change {hit|turned|moved} cell/measurements.csv {}.csv
        @change few cell/measurements.csv few.csv
        @change hit+few cell/measurements.csv hit-few.csv
        track cell/results/calibration.json {hit|turned|moved}.csv --json
        track cell/results/calibration.json few.csv --history none
        track cell/results/calibration.json hit.csv --repeatability 0.05mm --recalibrate joint4 --out by-model.json
        track cell/results/calibration.json hit-few.csv --reference few.csv --history none
        track cell/results/calibration.json hit.csv --repeatability 0.05mm --device known --tool refit --history visits.jsonl
        track fixed/based/calibration.json fixed/measurements.csv
        export {cell|fixed}/actual.urdf --offset joint4=0.3deg --out {}/hit.urdf
        simulate cell/hit.urdf --errors 0deg,0mm --kind point --count 60 --seed 3 --out cell/visit
        simulate fixed/hit.urdf --errors 0deg,0mm --kind point --count 60 --seed 3 --device-frame base --out fixed/visit
        track cell/results/calibration.json cell/visit/measurements.csv --repeatability 0.05mm --recalibrate joint4 --out recalibrated.json
        track fixed/based/calibration.json fixed/visit/measurements.csv --repeatability 0.05mm --history visits.jsonl --json
        track cell/results/calibration.json hit.csv --recalibrate joint2.axis --out no.json
        validate cell/results/calibration.json hit.csv --history none
        export recalibrated.json --format urdf
        compare cell/results/calibration.json recalibrated.json
        report cell/results/calibration.json --out with-visits.html
    """,
    "line": """
        @take examples/elbow/robot.urdf
        @text station.toml line.toml no.csv
        simulate robot.urdf --kind point --count 30 --errors 0.03deg,0.2mm --out made
        @line made/measurements.csv 32
        @copy no.csv inbox/SN0040/2026-04-01.csv
        fleet station.toml
        fleet station.toml    # nothing is left to do
        fleet report station.toml
        fleet prior station.toml
        @copy made/measurements.csv inbox/SN0041/2026-04-02.csv
        fleet station.toml --shard {1|2}/2
        fleet report station.toml --force
        fleet station.toml --rerun
        fleet absent.toml
        fleet line.toml
    """,
    "programs": """
        @arm {kuka|ur|fanuc|abb}
        @take crates/poecal-compensate/tests/it/programs/fanuc/*.ls
        @take crates/poecal-compensate/tests/it/programs/rapid/*.*
        @text part.src part.dat part.script bare.script
        @seed programs/{fanuc|krl|rapid|urscript} {}.txt
        simulate {kuka|ur|fanuc|abb}.toml --errors 0.03deg,0.3mm --count 40 --out s-{}
        calibrate {kuka|ur|fanuc|abb}.toml s-{}/measurements.csv --corrections off --report none --out {}
        compensate kuka/calibration.json part.src --check --out out.src
        compensate kuka/calibration.json part.dat --tool-data 1=10,-20,150,10,20,30 --work-object 7=400,100,50,90,0,0 --json --out out.dat
        compensate kuka/calibration.json part.dat --dry-run
        compensate kuka/calibration.json krl.txt --language krl --nearest
        compensate ur/calibration.json part.script --check --out out.script
        compensate ur/calibration.json bare.script --tool-data 0,0,0.1,0,0,0
        compensate ur/calibration.json bare.script --tool-data 0,0,0.1,0,0,0 --start 0.1745,-1.2217,1.3963,-1.7453,-1.3963,0.3491
        compensate ur/calibration.json part.script --controller-base 0,0,0,0,0,3.14159 --controller-flange 0,0,-0.05,0,0,0.5 --max-correction 5deg,2mm
        compensate ur/calibration.json urscript.txt --language urscript --json
        compensate fanuc/calibration.json {01_simple|02_joints|03_frames_and_tools|05_arcs|07_registers|09_external_axes|14_line_ends|20_branches}.ls --tool-data 1=12.5,-3,145.25,0,0,0 --tool-data 2=80,0,110,0,-45,0 --work-object 1=350,-220,-180,0,0,90 --check
        compensate fanuc/calibration.json 01_simple.ls --third-axis {level|arm} --tool-data 1=0,0,100,0,0,0 --json --out {}.ls
        compensate abb/calibration.json {01_simple.mod|02_in_place.prg|03_work_objects.mod|06_arrays.mod|10_external_axes.mod|12_displaced.mod|17_flow.mod|20_modules.sys} --check
        compensate abb/calibration.json part.src
        compensate abb.toml 01_simple.mod
    """,
    "bad-tables": """
        @take examples/elbow/*
        @change {no-column|twice|no-number|infinite|short|metres|inches|radians|wrong-unit|no-units|swapped|negated|shifted|few|one} points.csv {}.csv
        @text no.csv no-rows.csv wrong.toml broken.toml no.json
        @semicolons points.csv german.csv
        @cut points.csv cut.csv 4003
        calibrate robot.urdf {no-column|twice|no-number|infinite|short|metres|inches|radians|wrong-unit|no-units|swapped|negated|shifted|few|one}.csv --out out-{}
        calibrate robot.urdf {no|no-rows|german|cut}.csv --out out-{}
        calibrate robot.urdf no-units.csv --units mm,deg --out units
        calibrate robot.urdf points.csv --columns {wrong|broken|absent}.toml --out no
        check robot.urdf {no-units|swapped|negated|shifted|no-column}.csv
        predict robot.urdf {no|no-column|wrong-unit}.csv
        validate no.json points.csv
        export no.json --format toml
    """,
    "bad-words": """
        @take examples/elbow/*
        @cut robot.urdf cut.urdf 700
        @cut robot.toml cut.toml 500
        calibrate robot.urdf points.csv --quiet
        nonsense
        {apply|board|certificate|convert|identify} robot.urdf    # old words
        plan robot.urdf --workspace limits
        track robot.urdf points.csv --tool refit
        calibrat robot.urdf points.csv
        calibrate robot.urdf points.csv --no-such-option
        calibrate robot.urdf points.csv --held-out {2|some|-1} --out no
        calibrate robot.urdf points.csv --sigma-position {0.05|0.05deg|-1mm|nan} --out no
        calibrate robot.urdf points.csv --corrections {sags|sag=-1} --out no
        calibrate robot.urdf points.csv --{fix|free} joint9 --out no
        calibrate robot.urdf points.csv --tip-link nowhere --out no
        calibrate robot.urdf points.csv --gravity 0,0,0 --out no
        calibrate robot.urdf points.csv --train-where stage=1 --out no
        calibrate robot.urdf points.csv --record colour=red --out no
        calibrate robot.urdf points.csv --join sideways --out no
        calibrate robot.urdf points.csv --threads 0 --out no
        calibrate robot.urdf points.csv --out points.csv
        calibrate robot.urdf points.csv --out absent/folder
        calibrate robot.urdf points.csv points.csv --out no
        calibrate {absent.urdf|cut.urdf|cut.toml|points.csv|.} points.csv --out no
        calibrate robot.urdf {absent.csv|robot.urdf|README.md|.} --out no
        {simulate|export|plan|check|predict|init} absent.urdf
        simulate robot.urdf --kind smell --out no
        simulate robot.urdf --count 0 --out no
        simulate robot.urdf --errors 1mm --out no
        predict robot.urdf absent.csv
        export robot.urdf --format abacus
        validate robot.urdf points.csv
        track robot.urdf points.csv
        compare robot.urdf robot.toml
        compensate robot.urdf points.csv
        export robot.urdf --offset joint9=1deg
        export robot.urdf --out robot.obj
        report robot.urdf
        report poecal-out/calibration.json --certificate --record valid_until=tomorrow
        report poecal-out/calibration.json --certificate --logo points.csv
        hand-eye points.csv --camera above
        detect --print sudoku:9x9:20mm
        completions tcsh
        man nonsense
        fleet
        reproduce everything --out no
    """,
    "paper": """
        reproduce lou2009 --trials 2 --starts 1 --out lou
        reproduce lou2009 --trials 2 --starts 1 --out lou    # is there
        reproduce breakdown --trials 2 --out breakdown
    """,
}


def lists(line: str) -> str:
    """A line with lists of words in place of their names."""
    return re.sub(r"\{([A-Z]+)\}", lambda found: "{" + WORDS[found[1]] + "}", line)


def each(line: str) -> list[str]:
    """A line for each word of its first list; further lists make more of each."""
    found = re.search(r"\{([^{}]+)\}", line)
    if not found:
        return [line]
    return [one for word in found[1].split("|") for one in each((line[: found.start()] + word + line[found.end() :]).replace("{}", word))]


def lines(group: str) -> list[str]:
    """The lines of a group, each with its words."""
    stated = (line.split(" #")[0].strip() for line in GROUPS[group].splitlines())
    return [one for line in stated if line for one in each(lists(line))]
