// SPDX-License-Identifier: MIT
// A sweep as tasks of Nextflow, then one table:
//
//     nextflow run main.nf --scene drop.lua --points e=0.1:0.9:0.1 --tasks 3
//
// All tasks share the folder of the sweep, which must be on a file system that all nodes see. Status 75 means that points
// are left: the task is queued again and resumes from checkpoints, with the same bits.
params.scene = 'drop.lua'
params.points = 'e=0.1:0.9:0.1'
params.tasks = 3
params.folder = 'sweep'

process PLAN {
    input: val folder
    output: val folder
    script: "rbsim sweep ${file(params.scene)} -p ${params.points} -o ${folder} --plan --quiet"
}

process TASK {
    errorStrategy { task.exitStatus == 75 ? 'retry' : 'finish' }
    maxRetries 20
    input: tuple val(folder), val(k)
    output: val k
    script: "rbsim sweep ${folder} --task ${k} --tasks ${params.tasks} --jobs ${task.cpus} --quiet"
}

process TABLE {
    publishDir '.', mode: 'copy'
    input: val done
    val folder
    output: path "${params.folder}.csv"
    script: "rbsim collect ${folder} -o ${params.folder}.csv --quiet"
}

workflow {
    folder = PLAN("${launchDir}/${params.folder}")
    tasks = folder.combine(Channel.of(0..<params.tasks))
    TABLE(TASK(tasks).collect(), folder)
}
