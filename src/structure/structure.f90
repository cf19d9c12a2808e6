!> The structure of a set before anything is solved: the blocks of its independent mechanisms, its counts, its Assur
!> groups, and its missing and redundant equations, in words and by name.
!>
!> With n links, n1 revolute pairs, n2 prismatic pairs and n3 ground links, by the equations of 1987:
!>
!> (12)  r = 2 (n1 + n2) + 3 n3
!> (13)  s = 3 n - r        (the print subtracts 2 n1 + n2 only)
module structure
   use cards, only: card_forms, form_ground
   use failures, only: failure_t, fail, status_rejected
   use number_format, only: whole
   use names, only: drive_name, listed, more
   use disjoint_sets, only: once
   use mechanism, only: mechanism_t, has_guide, is_hidden, joined_by, shown_links, method_newton
   use matching, only: match, overdetermined, underdetermined
   use assur_groups, only: closure_incidence_t, new_closure, group_t, groups_of
   use independent, only: set_t, divide, part_of_links
   use block_structure, only: structure_t, make_structure
   use blocks, only: blocks_t
   implicit none
   private
   public :: structure_t, structure_report_t, group_t, make_structure, find_structure, find_groups, check_structure, &
      faults_text

   !> The structure of a set. A SLOT card has a hidden link, its block: `links` and `revolute` leave it and its revolute
   !> pair out, the counts from `coordinates` on do not.
   type :: structure_report_t
      integer :: links = 0        !< n, ground links included
      integer :: ground = 0       !< n3
      integer :: revolute = 0     !< n1
      integer :: prismatic = 0    !< n2
      integer :: coordinates = 0  !< w = 3 n
      integer :: equations = 0    !< r
      integer :: degrees_of_freedom = 0     !< s
      integer :: drives = 0       !< number of drives
      logical :: solvable = .false.             !< every unknown has an equation of its own
      integer :: free = 0                       !< how many unknowns have no equation
      integer, allocatable :: loose(:)          !< not solvable: numbers of the links among whose unknowns these are
      integer :: redundant = 0                  !< how many equations are too many
      !> Numbers of the pairs among whose equations these are, each pair once for each such equation.
      integer, allocatable :: many_pairs(:)
      integer, allocatable :: many_drives(:)    !< numbers of the drives among whose equations these are
      type(group_t), allocatable :: groups(:)   !< in solving order, after `find_groups`
      ! If each coordinate has a closure equation:
      type(set_t), allocatable :: set                   !< the divided set, if it has two independent mechanisms or more
      type(structure_t), allocatable :: structures(:)   !< (independent mechanisms)
   end type structure_report_t

   !> A job reports the faults of at most so many sets: the faults of ten sets are enough to mend.
   integer, parameter :: max_sets = 10

contains

   !> Finds the counts (12) and (13) of a set, the unknowns without equation, the redundant equations, and the structure
   !> of each independent mechanism. If a coordinate has no closure equation, no structure is made.
   function find_structure(m) result(f)
      type(mechanism_t), intent(in) :: m
      type(structure_report_t) :: f
      type(closure_incidence_t) :: c
      integer, allocatable :: unknown_of(:), equation_of(:), loose(:)
      logical, allocatable :: over(:)
      integer :: k, parts

      f%links = count(.not. m%links%hidden)
      f%ground = count(m%links%ground)
      f%prismatic = count(has_guide(m%pairs%kind))
      f%revolute = size(m%pairs) - f%prismatic - count(m%links%hidden)
      f%coordinates = 3*size(m%links)
      f%equations = 2*size(m%pairs) + 3*f%ground
      f%degrees_of_freedom = f%coordinates - f%equations
      f%drives = size(m%drives)

      c = new_closure(m)
      call match(c%incidence, unknown_of, equation_of)
      over = overdetermined(c%incidence, unknown_of, equation_of)
      f%redundant = count(unknown_of == 0)
      f%many_pairs = pack([((k + 1)/2, k=1, 2*size(m%pairs))], over(:2*size(m%pairs)))
      ! The hidden revolute pair of a SLOT card counts as the pair of that card.
      do k = 1, size(f%many_pairs)
         associate (pair => m%pairs(f%many_pairs(k)))
            if (is_hidden(m, pair)) f%many_pairs(k) = findloc(m%pairs%point_j, pair%point_i, dim=1)
         end associate
      end do

      f%many_drives = pack([(k, k=1, size(m%drives))], over(2*size(m%pairs) + 1:))
      f%free = count(equation_of == 0)
      if (f%free > 0) then
         f%loose = shown_links(m, once(pack(c%link_of, underdetermined(c%incidence, unknown_of, equation_of))))
         return
      end if

      parts = max(1, maxval([0, part_of_links(m)]))
      allocate (f%structures(parts))
      if (parts == 1) then
         call make_structure(m, f%structures(1))
      else
         allocate (f%set)
         call divide(m, f%set)
         do k = 1, parts
            call make_structure(f%set%parts(k), f%structures(k))
         end do
      end if
      f%solvable = all([(f%structures(k)%blocks%solvable, k=1, parts)])
      if (f%solvable) return

      ! Vector loops show more: two links that a prismatic pair joins have one angle, and a bar between two coincident
      ! points turns freely.
      f%free = sum([(f%structures(k)%blocks%free, k=1, parts)])
      f%loose = [integer ::]
      do k = 1, parts
         if (f%structures(k)%blocks%solvable) cycle
         loose = loose_links(f%structures(k)%blocks)
         if (parts > 1) loose = f%set%cards(k)%of(loose)
         f%loose = [f%loose, loose]
      end do
      f%loose = shown_links(m, f%loose)
   end function find_structure

   !> Finds the links that may lack an equation for their angle, their slide along their parent, or x and y of their
   !> root.
   pure function loose_links(blocks) result(links)
      type(blocks_t), intent(in) :: blocks   !< not solvable
      integer, allocatable :: links(:)       !< their numbers
      integer :: i, slide

      allocate (links(0))
      associate (t => blocks%tree)
         do i = 1, size(t%parent)
            slide = 0
            if (t%parent_joint(i) > 0) slide = t%slide(t%parent_joint(i))
            if (any(blocks%loose == t%orientation(i) .or. (slide > 0 .and. blocks%loose == t%orientations + slide) &
               .or. (t%root(i) > 0 .and. blocks%loose > t%orientations + t%slides))) links = [links, i]
         end do
      end associate
   end function loose_links

   !> Finds the Assur groups of a set, without the blocks of slots; none if the set is not solvable. Reason for a door
   !> of its own: only the listing has groups. Sets of a long job are checked one after another, but listed by several
   !> processes.
   subroutine find_groups(m, report)
      type(mechanism_t), intent(in) :: m
      type(structure_report_t), intent(inout) :: report   !< as `find_structure` made it; report%groups is set
      integer :: i

      if (.not. allocated(report%groups)) allocate (report%groups(0))
      if (.not. report%solvable) return
      report%groups = groups_of(m, new_closure(m))
      do i = 1, size(report%groups)
         report%groups(i)%links = pack(report%groups(i)%links, .not. m%links(report%groups(i)%links)%hidden)
      end do
      report%groups = pack(report%groups, [(size(report%groups(i)%links) > 0, i=1, size(report%groups))])
   end subroutine find_groups

   !> Checks that the motion of every link of every set can be found. After `max_sets` sets with faults it stops, and
   !> later sets have empty reports.
   subroutine check_structure(sets, structure_report, failure)
      type(mechanism_t), intent(in) :: sets(:)   !< (sets)
      type(structure_report_t), allocatable, intent(out) :: structure_report(:)   !< (sets)
      type(failure_t), allocatable, intent(out) :: failure   !< status_rejected with all faults; without: not allocated
      character(:), allocatable :: text, all_of_them
      integer :: i, reported

      allocate (structure_report(size(sets)))
      all_of_them = ''
      reported = 0
      do i = 1, size(sets)
         structure_report(i) = find_structure(sets(i))
         text = faults_text(sets(i), structure_report(i), sets(i)%set_number)
         if (len(text) == 0) cycle
         if (reported > 0) all_of_them = all_of_them//new_line('a')//' *** '
         all_of_them = all_of_them//text
         reported = reported + 1
         if (reported == max_sets) exit
      end do
      if (reported > 0) call fail(failure, status_rejected, all_of_them)
   end subroutine check_structure

   !> Names each fault of a set, in lines that are joined by new_line('a'); '' without a fault.
   function faults_text(m, report, set) result(text)
      type(mechanism_t), intent(in) :: m
      type(structure_report_t), intent(in) :: report   !< of `m`, by `find_structure`
      integer, intent(in) :: set   !< the number of the set in the deck
      character(:), allocatable :: text

      text = ''
      if (report%free == 0) then
         if (report%redundant > 0 .and. m%method /= method_newton) &
            call add_line('E104  SET '//whole(set)//': ONLY METHOD NEWTON TAKES '//redundancy_text(m, report))
         return
      end if
      if (report%ground == 0) then
         call add_line('E105  SET '//whole(set)//': NO LINK IS GROUND: GIVE IT A GROUND CARD')
         text = text//new_line('a')//' LAYOUT    |'//trim(card_forms(form_ground)%layout)
      end if
      call add_line('E101  SET '//whole(set)//': '//counted('LINK', m%links(report%loose)%name)//': ' &
         //whole(report%free)//' ' &
         //trim(merge('DEGREE OF FREEDOM NOT DRIVEN: ADD A DRIVE OR A PAIR', &
         'DEGREES OF FREEDOM NOT DRIVEN: ADD DRIVES OR PAIRS ', report%free == 1)))
      if (report%redundant > 0) call add_line('E102  SET '//whole(set)//': '//redundancy_text(m, report))
      text = text//joined_links(m, report)
      call add_line('E103  SET '//whole(set)//': W = '//whole(report%coordinates)//' COORDINATES LESS R = ' &
         //whole(report%equations)//' EQUATIONS LEAVE S = '//whole(report%degrees_of_freedom) &
         //' DEGREES OF FREEDOM, DRIVES ARE '//whole(report%drives))

   contains

      !> Appends a line to `text`; a line that is not the first begins with ' *** '.
      subroutine add_line(line)
         character(*), intent(in) :: line    !< without its end

         if (len(text) > 0) text = text//new_line('a')//' *** '
         text = text//line
      end subroutine add_line

   end function faults_text

   !> Lists names after a word, which has its plural for two names or more: LINK A, or LINKS A, B.
   function counted(word, names) result(text)
      character(*), intent(in) :: word       !< for one of them
      character(*), intent(in) :: names(:)   !< (1 or more) the names
      character(:), allocatable :: text

      text = word//trim(merge(' ', 'S', size(names) == 1))//' '//listed(names, .false.)
   end function counted

   !> Names the two links of each pair of a link that still can move, and of each pair with redundant equations: a JOINT
   !> card may have a wrong link. Each line begins with new_line('a'). Without JOINT cards the text is ''.
   function joined_links(m, report) result(text)
      type(mechanism_t), intent(in) :: m
      type(structure_report_t), intent(in) :: report   !< of `m`, not solvable
      character(:), allocatable :: text
      !> Pairs in a line, which with three names each fits into 80 columns; and in all: ten lines.
      integer, parameter :: pairs_a_line = 4, most = 40
      integer :: i, n, ends(2)

      text = ''
      if (.not. any(m%points%drawn)) return
      n = 0
      do i = 1, size(m%pairs)
         if (is_hidden(m, m%pairs(i))) cycle
         ends = joined_by(m, m%pairs(i))
         if (.not. (any(report%many_pairs == i) .or. any(report%loose == ends(1)) .or. any(report%loose == &
            ends(2)))) cycle
         n = n + 1
         if (n > most) cycle
         if (mod(n, pairs_a_line) == 1) then
            text = text//new_line('a')//' LINKS     |'
         else
            text = text//', '
         end if
         text = text//trim(m%pairs(i)%name)//' ('//listed(m%links(ends)%name, .false.)//')'
      end do
      text = text//more(max(0, n - most), .false.)
   end function joined_links

   !> Names pairs and drives with redundant equations: TOO MANY EQUATIONS BY 1 AMONG PAIRS A, B AND DRIVES ...
   function redundancy_text(m, report) result(text)
      type(mechanism_t), intent(in) :: m
      type(structure_report_t), intent(in) :: report   !< of `m`, with redundant equations
      character(:), allocatable :: text
      integer, allocatable :: pairs(:)
      integer :: i

      pairs = once(report%many_pairs)
      text = 'TOO MANY EQUATIONS BY '//whole(report%redundant)//' AMONG '
      if (size(pairs) > 0) text = text//counted('PAIR', m%pairs(pairs)%name)
      if (size(pairs) > 0 .and. size(report%many_drives) > 0) text = text//' AND '
      if (size(report%many_drives) > 0) text = text//counted('DRIVE', &
         [(drive_name(m, m%drives(report%many_drives(i))), i=1, size(report%many_drives))])
   end function redundancy_text
end module structure
