!> What is wrong with a mechanism's structure, in words and by name.
module structure_faults
   use kinds, only: label_length
   use mechanism, only: mechanism_t, method_newton
   use failures, only: failure_t, fail, status_rejected
   use structure, only: findings_t, part_t, find_structure
   use numerals, only: whole
   use names, only: drive_name, listed
   implicit none
   private
   public :: check_structure, faults_text

   !> So many parts are told by name; of more, the number.
   integer, parameter :: max_substeps = 20

   !> Of so many sets it is told what is wrong with them.
   integer, parameter :: max_sets = 10

contains

   !> Every link of every set can be found: `findings` (sets).
   subroutine check_structure(sets, findings, failure)
      type(mechanism_t), intent(in) :: sets(:)
      type(findings_t), allocatable, intent(out) :: findings(:)
      type(failure_t), allocatable, intent(out) :: failure
      character(:), allocatable :: text, all_of_them
      integer :: i, told

      allocate (findings(size(sets)))
      all_of_them = ''
      told = 0
      do i = 1, size(sets)
         findings(i) = find_structure(sets(i))
         text = faults_text(sets(i), findings(i), i)
         if (len(text) == 0) cycle
         if (told > 0) all_of_them = all_of_them//new_line('a')//' *** '
         all_of_them = all_of_them//text
         told = told + 1
         if (told == max_sets) exit
      end do
      if (told > 0) call fail(failure, status_rejected, all_of_them)
   end subroutine check_structure

   !> A line for each fault of set number `set`, joined by new_line('a'); '' where there is none.
   function faults_text(m, f, set) result(text)
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(in) :: f
      integer, intent(in) :: set
      character(:), allocatable :: text
      integer :: i

      text = ''
      if (size(f%lacking) == 0) then
         if (f%redundant > 0 .and. m%method /= method_newton) &
            call add_line('E104  SET '//whole(set)//': ONLY METHOD NEWTON TAKES '//surplus(m, f))
         return
      end if
      do i = 1, min(size(f%lacking), max_substeps)
         call add_line('E101  SET '//whole(set)//': '//lack(m, f%lacking(i)))
      end do
      if (size(f%lacking) > max_substeps) call add_line('E101  SET '//whole(set)//': AND ' &
         //whole(size(f%lacking) - max_substeps)//' MORE PARTS THAT CAN MOVE')
      if (f%redundant > 0) call add_line('E102  SET '//whole(set)//': '//surplus(m, f))
      call add_line('E103  SET '//whole(set)//': W = '//whole(f%coordinates)//' COORDINATES LESS R = ' &
         //whole(f%equations)//' EQUATIONS LEAVE S = '//whole(f%degrees_of_freedom) &
         //' DEGREES OF FREEDOM, DRIVES ARE '//whole(f%drives))

   contains

      subroutine add_line(line)
         character(*), intent(in) :: line

         if (len(text) > 0) text = text//new_line('a')//' *** '
         text = text//line
      end subroutine add_line
   end function faults_text

   !> LINKS A, B: 1 FREEDOM LEFT, ADD A DRIVE
   function lack(m, part) result(text)
      type(mechanism_t), intent(in) :: m
      type(part_t), intent(in) :: part
      character(:), allocatable :: text

      text = 'LINKS '
      if (size(part%links) == 1) text = 'LINK '
      text = text//listed(m%links(part%links)%name)//': '
      if (part%degrees_of_freedom == 1) then
         text = text//'1 FREEDOM LEFT, ADD A DRIVE'
      else
         text = text//whole(part%degrees_of_freedom)//' DEGREES OF FREEDOM LEFT, ADD DRIVES'
      end if
   end function lack

   !> TOO MANY EQUATIONS BY 1 AMONG PAIRS A, B AND DRIVES ...
   function surplus(m, f) result(text)
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(in) :: f
      character(:), allocatable :: text
      character(3*label_length + 2) :: drives(size(f%many_drives))
      integer :: i
      integer, allocatable :: pairs(:)

      pairs = once(f%many_pairs)
      text = 'TOO MANY EQUATIONS BY '//whole(f%redundant)//' AMONG'
      if (size(pairs) > 0) text = text//trim(merge(' PAIR ', ' PAIRS', size(pairs) == 1))//' ' &
         //listed(m%pairs(pairs)%name)
      if (size(drives) == 0) return
      if (size(pairs) > 0) text = text//' AND'
      do i = 1, size(drives)
         drives(i) = drive_name(m, m%drives(f%many_drives(i)))
      end do
      text = text//trim(merge(' DRIVE ', ' DRIVES', size(drives) == 1))//' '//listed(drives)
   end function surplus

   !> The first of each run of equal numbers.
   pure function once(list) result(short)
      integer, intent(in) :: list(:)
      integer, allocatable :: short(:)
      integer :: i

      short = pack(list, [(i == 1 .or. list(max(i - 1, 1)) /= list(i), i=1, size(list))])
   end function once
end module structure_faults
